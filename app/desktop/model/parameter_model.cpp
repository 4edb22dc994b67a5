#include "model/parameter_model.h"

#include <algorithm>
#include <utility>

#include "plenoflame/base/error.h"

namespace plenoflame::desktop {
namespace {

/// "camera.lens.surfaces[2].radius" -> "camera", "lens", "surfaces", "[2]", "radius".
std::vector<std::string> segments(const std::string& path) {
  std::vector<std::string> out;
  std::string current;
  const auto finish = [&] {
    if (!current.empty()) out.push_back(std::exchange(current, {}));
  };
  for (const char c : path) {
    if (c == '.') {
      finish();
      continue;
    }
    if (c == '[') finish();
    current += c;
  }
  finish();
  return out;
}

QString readable(const std::string& word) {
  QString text = QString::fromStdString(word);
  return text.replace('_', ' ');
}

}  // namespace

struct ParameterModel::Node {
  std::string path;     ///< with indices
  std::string segment;  ///< last part of it
  const SchemaKey* key = nullptr;
  bool is_list = false;
  int item = -1;  ///< of the list above
  int row = 0;
  Node* parent = nullptr;
  std::vector<std::unique_ptr<Node>> children;

  Node* child(const std::string& name) {
    for (const auto& c : children)
      if (c->segment == name) return c.get();
    auto node = std::make_unique<Node>();
    node->segment = name;
    node->path = path.empty() ? name : name.front() == '[' ? path + name : path + "." + name;
    if (name.front() == '[') node->item = std::stoi(name.substr(1));
    node->parent = this;
    node->row = static_cast<int>(children.size());
    children.push_back(std::move(node));
    return children.back().get();
  }
};

ParameterModel::ParameterModel(Document& document, QObject* parent)
    : QAbstractItemModel(parent), document_(document), root_(std::make_unique<Node>()) {
  connect(&document_, &Document::scene_changed, this, [this] { refresh(); });
  rebuild();
}

ParameterModel::~ParameterModel() = default;

void ParameterModel::rebuild() {
  beginResetModel();
  root_ = std::make_unique<Node>();
  paths_ = document_.is_empty() ? std::vector<std::string>{} : scene_paths(document_.scene());
  if (!document_.is_empty()) {
    // Lists show even when they are empty, so that something can be added; in the order of files.
    for (const SchemaList& list : schema_lists()) {
      if (list.path.find('[') != std::string_view::npos) continue;
      if (list_size(document_.scene(), list.path) > 0) continue;
      Node* node = root_.get();
      for (const std::string& part : segments(std::string(list.path))) node = node->child(part);
      node->is_list = true;
    }
    for (const std::string& path : paths_) {
      Node* node = root_.get();
      for (const std::string& part : segments(path)) {
        Node* const next = node->child(part);
        if (part.front() == '[') node->is_list = true;
        node = next;
      }
      node->key = find_schema_key(path);
    }
    // Files begin with the camera, the tree does, too.
    auto& top = root_->children;
    std::stable_sort(top.begin(), top.end(), [](const auto& a, const auto& b) {
      const auto rank = [](const Node& node) {
        const std::vector<std::string> order{"camera",   "flames", "surfaces", "lights",
                                             "channels", "render", "develop"};
        return std::find(order.begin(), order.end(), node.segment) - order.begin();
      };
      return rank(*a) < rank(*b);
    });
    for (std::size_t i = 0; i < top.size(); ++i) top[i]->row = static_cast<int>(i);
  }
  endResetModel();
}

void ParameterModel::announce(Node& node) {
  const QModelIndex first = createIndex(node.row, kName, &node),
                    last = createIndex(node.row, kAllowed, &node);
  emit dataChanged(first, last);
  for (const auto& child : node.children) announce(*child);
}

void ParameterModel::refresh() {
  refused_.clear();
  const auto paths =
      document_.is_empty() ? std::vector<std::string>{} : scene_paths(document_.scene());
  if (paths != paths_ || root_->children.empty()) {
    rebuild();
    return;
  }
  for (const auto& child : root_->children) announce(*child);
}

ParameterModel::Node* ParameterModel::node_of(const QModelIndex& index) const {
  return index.isValid() ? static_cast<Node*>(index.internalPointer()) : root_.get();
}

QModelIndex ParameterModel::index(int row, int column, const QModelIndex& parent) const {
  const Node* const node = node_of(parent);
  if (row < 0 || column < 0 || column >= kColumns || row >= static_cast<int>(node->children.size()))
    return {};
  return createIndex(row, column, node->children[static_cast<std::size_t>(row)].get());
}

QModelIndex ParameterModel::parent(const QModelIndex& index) const {
  if (!index.isValid()) return {};
  Node* const parent = node_of(index)->parent;
  return parent == root_.get() || !parent ? QModelIndex() : createIndex(parent->row, 0, parent);
}

int ParameterModel::rowCount(const QModelIndex& parent) const {
  return parent.column() > 0 ? 0 : static_cast<int>(node_of(parent)->children.size());
}

int ParameterModel::columnCount(const QModelIndex&) const {
  return kColumns;
}

QString ParameterModel::message_of(const Node& node, bool* is_error) const {
  const auto refusal = refused_.find(node.path);
  if (refusal != refused_.end()) {
    if (is_error) *is_error = true;
    return refusal->second.message;
  }
  for (const SceneIssue& issue : document_.issues()) {
    // An issue about a table shows at the table.
    if (issue.key != node.path &&
        !(issue.key.empty() && node.parent == root_.get() && node.row == 0))
      continue;
    if (is_error) *is_error = issue.is_error;
    return QString::fromStdString(issue.message);
  }
  return {};
}

QVariant ParameterModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const Node& node = *node_of(index);
  const auto value = [&]() -> QString {
    const auto refusal = refused_.find(node.path);
    if (refusal != refused_.end()) return refusal->second.text;
    return node.key ? QString::fromStdString(get_text(document_.scene(), node.path)) : QString();
  };
  switch (role) {
    case Qt::DisplayRole:
      if (index.column() == kName) {
        if (node.item < 0) return readable(node.segment);
        // Items are told apart by their names where they have some.
        const SchemaKey* const name = find_schema_key(node.path + ".name");
        const QString text =
            name ? QString::fromStdString(get_text(document_.scene(), node.path + ".name"))
                 : QString();
        return text.isEmpty() ? QString::number(node.item + 1)
                              : QString("%1: %2").arg(node.item + 1).arg(text);
      }
      if (index.column() == kValue) {
        if (node.is_list)
          return node.children.size() == 1 ? tr("1 item")
                                           : tr("%1 items").arg(node.children.size());
        return value();
      }
      return node.key ? QString::fromStdString(range_text(*node.key)) : QString();
    case Qt::EditRole:
      return value();
    case Qt::ToolTipRole: {
      QString text;
      if (node.key) {
        const auto unit = si_unit(node.key->dimension);
        text = QString("<b>%1</b><br>%2")
                   .arg(QString::fromStdString(node.path).toHtmlEscaped(),
                        QString::fromUtf8(node.key->description.data(),
                                          static_cast<int>(node.key->description.size()))
                            .toHtmlEscaped());
        if (!unit.empty()) {
          QStringList units;
          for (const std::string& name : accepted_units(node.key->dimension))
            units << QString::fromStdString(name);
          text += tr("<br>Units: %1").arg(units.join(", ").toHtmlEscaped());
        }
        const QString range = QString::fromStdString(range_text(*node.key));
        if (!range.isEmpty()) text += tr("<br>Allowed: %1").arg(range.toHtmlEscaped());
        if (!is_required(*node.key))
          text +=
              tr("<br>Default: %1")
                  .arg(QString::fromStdString(value_to_text(*node.key, default_value(*node.key)))
                           .toHtmlEscaped());
      } else {
        const std::string schema_path = parse_path(node.path).schema_path;
        for (const SchemaTable& table : schema_tables())
          if (table.path == schema_path || table.path == schema_path + "[]")
            text = QString::fromUtf8(table.description.data(),
                                     static_cast<int>(table.description.size()))
                       .toHtmlEscaped();
      }
      const QString message = message_of(node, nullptr);
      if (!message.isEmpty()) text += "<br><b>" + message.toHtmlEscaped() + "</b>";
      return text;
    }
    case kPathRole:
      return QString::fromStdString(node.path);
    case kChoicesRole: {
      QStringList choices;
      if (node.key && node.key->type == ValueType::boolean)
        choices << "true"
                << "false";
      if (node.key && node.key->type == ValueType::choice)
        for (const std::string_view word : node.key->choices)
          choices << QString::fromUtf8(word.data(), static_cast<int>(word.size()));
      return choices;
    }
    case kMessageRole:
      return message_of(node, nullptr);
    case kIsErrorRole: {
      bool is_error = false;
      message_of(node, &is_error);
      return is_error;
    }
    case kListRole:
      if (node.is_list) return QString::fromStdString(node.path);
      return node.item >= 0 ? QString::fromStdString(node.parent->path) : QString();
    case kItemRole:
      return node.item;
    case kPresetRole:
      if (!node.key) {
        const std::string schema_path = parse_path(node.path).schema_path;
        for (const SchemaTable& table : schema_tables())
          if (table.has_preset && table.path == schema_path) return static_cast<int>(table.preset);
      }
      return -1;
    default:
      return {};
  }
}

QVariant ParameterModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  switch (section) {
    case kName:
      return tr("Parameter");
    case kValue:
      return tr("Value");
    case kAllowed:
      return tr("Allowed");
    default:
      return {};
  }
}

Qt::ItemFlags ParameterModel::flags(const QModelIndex& index) const {
  if (!index.isValid()) return Qt::NoItemFlags;
  Qt::ItemFlags flags = Qt::ItemIsEnabled | Qt::ItemIsSelectable;
  if (index.column() == kValue && node_of(index)->key) flags |= Qt::ItemIsEditable;
  return flags;
}

bool ParameterModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  if (role != Qt::EditRole || !index.isValid() || index.column() != kValue) return false;
  Node& node = *node_of(index);
  if (!node.key) return false;
  const std::string path = node.path;
  const QString text = value.toString();
  try {
    document_.set_value(path, text.toStdString());
    // The tree may be another one now; what was refused before is corrected.
    if (refused_.erase(path) > 0) {
      const QModelIndex here = find(path, kName);
      emit dataChanged(here, here.siblingAtColumn(kAllowed));
    }
    return true;
  } catch (const Error& error) {
    const QString message = QString::fromUtf8(error.what());
    refused_[path] = {text, message};
    emit dataChanged(index.siblingAtColumn(kName), index.siblingAtColumn(kAllowed));
    emit refused(QString::fromStdString(path), message);
    return false;
  }
}

QModelIndex ParameterModel::find(const std::string& path, int column) const {
  Node* node = root_.get();
  for (const std::string& part : segments(path)) {
    const auto found = std::find_if(node->children.begin(), node->children.end(),
                                    [&](const auto& child) { return child->segment == part; });
    if (found == node->children.end()) return {};
    node = found->get();
  }
  return node == root_.get() ? QModelIndex() : createIndex(node->row, column, node);
}

}  // namespace plenoflame::desktop

#include "model/parameter_model.h"

#include <algorithm>
#include <utility>

#include "model/key_relevance.h"
#include "model/scene_values.h"
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

int components_of(const SchemaKey* key) {
  if (!key) return 0;
  return key->type == ValueType::vector3 ? 3 : key->type == ValueType::vector2 ? 2 : 0;
}

/// The parts of "1 m, 0 m, 2 m".
std::vector<std::string> components(const std::string& text) {
  std::vector<std::string> out;
  for (const QString& part : QString::fromStdString(text).split(','))
    out.push_back(part.trimmed().toStdString());
  return out;
}

std::string value_path(const std::string& path) {
  return ParameterModel::place_of(path).path;
}

std::string text_of(const Scene& scene, const std::string& path) {
  const ParameterModel::Place place = ParameterModel::place_of(path);
  const std::string text = value_text(scene, place.path);
  return place.component < 0 ? text
                             : components(text).at(static_cast<std::size_t>(place.component));
}

/// The whole value with one of its components replaced.
std::string with_component(const Scene& scene, const ParameterModel::Place& place,
                           const std::string& text) {
  if (place.component < 0) return text;
  std::string out;
  const std::vector<std::string> parts = components(value_text(scene, place.path));
  for (std::size_t k = 0; k < parts.size(); ++k)
    out += (k == 0 ? "" : ", ") + (static_cast<int>(k) == place.component ? text : parts[k]);
  return out;
}

/// The values that validate() accepts for camera.focus.conjugate.
QStringList conjugates(const Scene& scene, const std::string& path) {
  const ParsedPath parsed = parse_path(path);
  const CameraSpec& camera =
      parsed.indices.empty() ? scene.camera : scene.cameras.at(parsed.indices.front());
  if (!camera.array.present) return {"sensor"};
  QStringList names{"array"};
  for (const auto& type : camera.array.types)
    if (!type.name.empty()) names << QString::fromStdString(type.name);
  return names;
}

/// "front of lens 2", "stop"; empty where the path is none of a lens' surfaces.
QString lens_surface_name(const Scene& scene, const std::string& path) {
  const ParsedPath parsed = parse_path(path);
  if (!parsed.schema_path.ends_with("lens.surfaces[]")) return {};
  const MainLensSpec& lens =
      parsed.indices.size() < 2 ? scene.camera.lens : scene.cameras.at(parsed.indices.front()).lens;
  const auto in_glass = [](const SurfaceSpec& s) { return s.index != 1 || !s.glass.empty(); };
  int number = 0;
  bool before = false;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    const bool behind = in_glass(lens.surfaces[i]);
    if (behind) ++number;
    if (i == parsed.indices.back()) {
      if (!before && !behind)
        return lens.surfaces[i].stop ? QObject::tr("stop") : QObject::tr("air");
      const QString stop = lens.surfaces[i].stop ? QObject::tr(", stop") : QString();
      return (before && behind ? QObject::tr("between lens %1 and %2").arg(number - 1).arg(number)
              : behind         ? QObject::tr("front of lens %1").arg(number)
                               : QObject::tr("back of lens %1").arg(number)) +
             stop;
    }
    before = behind;
  }
  return {};
}

}  // namespace

ParameterModel::Place ParameterModel::place_of(const std::string& path) {
  Place place;
  place.path = path;
  place.key = find_value(path);
  if (place.key || path.size() < 3 || path[path.size() - 2] != '.') return place;
  const std::string whole = path.substr(0, path.size() - 2);
  const std::size_t component = std::string("xyz").find(path.back());
  const SchemaKey* const key = find_schema_key(whole);
  if (component == std::string::npos || static_cast<int>(component) >= components_of(key))
    return place;
  return {key, whole, static_cast<int>(component)};
}

struct ParameterModel::Node {
  std::string path;     ///< with indices
  std::string segment;  ///< last part of it
  const SchemaKey* key = nullptr;
  int component = -1;  ///< of the key's vector; -1: all of the value
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
  connect(&document_, &Document::issues_changed, this, [this] { follow(); });
  rebuild();
}

ParameterModel::~ParameterModel() = default;

void ParameterModel::rebuild() {
  beginResetModel();
  root_ = std::make_unique<Node>();
  paths_ = document_.is_empty() ? std::vector<std::string>{} : value_paths(document_.scene());
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
      node->key = find_value(path);
      const int components = components_of(node->key);
      for (int k = 0; k < components; ++k) {
        Node* const part = node->child(std::string(1, "xyz"[k]));
        part->key = node->key;
        part->component = k;
      }
    }
    // Files begin with the camera, the tree does, too.
    auto& top = root_->children;
    std::stable_sort(top.begin(), top.end(), [](const auto& a, const auto& b) {
      const auto rank = [](const Node& node) {
        const std::vector<std::string> order{"camera", "cameras",  "flames", "surfaces",
                                             "lights", "channels", "render", "develop"};
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
  if (!refused_.empty()) {
    refused_.clear();
    emit refusals_changed();
  }
  follow();
}

/// Issues may belong to a scene that the model has not received yet.
void ParameterModel::follow() {
  const auto paths =
      document_.is_empty() ? std::vector<std::string>{} : value_paths(document_.scene());
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
  if (const Refusal* const refusal = refusal_of(node.path)) {
    if (is_error) *is_error = true;
    return refusal->message;
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
    if (const Refusal* const refusal = refusal_of(node.path)) return refusal->text;
    return node.key ? QString::fromStdString(text_of(document_.scene(), node.path)) : QString();
  };
  switch (role) {
    case Qt::DisplayRole:
      if (index.column() == kName) {
        if (node.component >= 0) return readable(node.segment).toUpper();
        if (node.item < 0) return readable(node.segment);
        if (const QString name = lens_surface_name(document_.scene(), node.path); !name.isEmpty())
          return QString("%1: %2").arg(node.item + 1).arg(name);
        // Items are identified by their names, if they have names.
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
      const std::string reason = irrelevance(document_.scene(), value_path(node.path));
      if (!reason.empty())
        text +=
            tr("<br>Without effect now: %1").arg(QString::fromStdString(reason).toHtmlEscaped());
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
      if (node.key && node.path.ends_with("focus.conjugate"))
        choices = conjugates(document_.scene(), node.path);
      return choices;
    }
    case kReasonRole:
      return QString::fromStdString(irrelevance(document_.scene(), value_path(node.path)));
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
  return role == Qt::EditRole && set_value(index, value.toString(), {});
}

const ParameterModel::Refusal* ParameterModel::refusal_of(const std::string& path) const {
  const auto found = std::find_if(refused_.begin(), refused_.end(), [&](const Refusal& refusal) {
    return refusal.path == QString::fromStdString(path);
  });
  return found == refused_.end() ? nullptr : &*found;
}

void ParameterModel::forget_refusal() {
  if (refused_.empty()) return;
  const std::string path = refused_.back().path.toStdString();
  refused_.pop_back();
  const QModelIndex here = find(path, kName);
  if (here.isValid()) emit dataChanged(here, here.siblingAtColumn(kAllowed));
  emit refusals_changed();
}

bool ParameterModel::set_value(const QModelIndex& index, const QString& text,
                               const std::string& merge) {
  if (!index.isValid() || index.column() != kValue) return false;
  Node& node = *node_of(index);
  if (!node.key) return false;
  const std::string path = node.path;
  const auto same = [&](const Refusal& refusal) {
    return refusal.path == QString::fromStdString(path);
  };
  try {
    const Place place = place_of(path);
    document_.set_value(place.path, with_component(document_.scene(), place, text.toStdString()),
                        merge);
    // The tree may be another one now; what was refused before is corrected.
    if (std::erase_if(refused_, same) > 0) {
      emit refusals_changed();
      const QModelIndex here = find(path, kName);
      emit dataChanged(here, here.siblingAtColumn(kAllowed));
    }
    return true;
  } catch (const Error& error) {
    const QString message = QString::fromUtf8(error.what());
    std::erase_if(refused_, same);
    refused_.push_back({QString::fromStdString(path), text, message});
    emit refusals_changed();
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

#include "widgets/panels/scene_panel.h"

#include <QApplication>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QMenu>
#include <QPainter>
#include <QSlider>
#include <QStyledItemDelegate>
#include <QTreeView>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame::desktop {
namespace {

constexpr int kSliderSteps = 400;    ///< to each side of the middle
constexpr double kSliderFactor = 2;  ///< by which the ends differ from the middle

constexpr int kValueWidth = 130, kIndentation = 14;  ///< [logical pixel]
/// [logical pixel] below which there is room for names and values alone; what is allowed stands in
/// the tooltips, too.
constexpr int kWidePanel = 460;
constexpr int kLeastTreeRows = 10;
constexpr double kReachOfNothing = 0.1;  ///< of components that are all 0, in SI units

std::vector<double> components_of(const SchemaValue& value) {
  if (const auto* const v = std::get_if<Vec3>(&value)) return {v->x, v->y, v->z};
  if (const auto* const v = std::get_if<Vec2>(&value)) return {v->x, v->y};
  return {0};
}

/// Choices as a list; wrong values on red.
class ValueDelegate : public QStyledItemDelegate {
 public:
  using QStyledItemDelegate::QStyledItemDelegate;

  QWidget* createEditor(QWidget* parent, const QStyleOptionViewItem& option,
                        const QModelIndex& index) const override {
    const QStringList choices = index.data(ParameterModel::kChoicesRole).toStringList();
    if (choices.isEmpty()) return QStyledItemDelegate::createEditor(parent, option, index);
    auto* box = new QComboBox(parent);
    box->addItems(choices);
    connect(box, QOverload<int>::of(&QComboBox::activated), this, [this, box] {
      auto* const self = const_cast<ValueDelegate*>(this);
      emit self->commitData(box);
      emit self->closeEditor(box);
    });
    return box;
  }
  void setEditorData(QWidget* editor, const QModelIndex& index) const override {
    if (auto* box = qobject_cast<QComboBox*>(editor))
      box->setCurrentText(index.data(Qt::EditRole).toString());
    else
      QStyledItemDelegate::setEditorData(editor, index);
  }
  void setModelData(QWidget* editor, QAbstractItemModel* model,
                    const QModelIndex& index) const override {
    if (auto* box = qobject_cast<QComboBox*>(editor))
      model->setData(index, box->currentText());
    else
      QStyledItemDelegate::setModelData(editor, model, index);
  }

 protected:
  void initStyleOption(QStyleOptionViewItem* option, const QModelIndex& index) const override {
    QStyledItemDelegate::initStyleOption(option, index);
    if (index.column() == ParameterModel::kAllowed ||
        !index.data(ParameterModel::kReasonRole).toString().isEmpty())
      option->palette.setColor(QPalette::Text,
                               option->palette.color(QPalette::Disabled, QPalette::Text));
    if (index.data(ParameterModel::kMessageRole).toString().isEmpty()) return;
    const bool is_error = index.data(ParameterModel::kIsErrorRole).toBool();
    option->backgroundBrush = is_error ? QColor(179, 38, 30) : QColor(230, 159, 0);
    option->palette.setColor(QPalette::Text, is_error ? Qt::white : Qt::black);
  }
};

}  // namespace

ScenePanel::ScenePanel(Document& document, QWidget* parent)
    : QWidget(parent),
      document_(document),
      model_(new ParameterModel(document, this)),
      camera_(new QComboBox(this)),
      tree_(new QTreeView(this)),
      message_(new QLabel(this)),
      slider_(new QSlider(Qt::Horizontal, this)),
      slider_label_(new QLabel(this)) {
  camera_->setObjectName("cameraChoice");
  camera_->setToolTip(tr("The camera that is rendered, traced and shown"));
  camera_->hide();
  tree_->setObjectName("sceneTree");
  tree_->setModel(model_);
  tree_->setItemDelegate(new ValueDelegate(tree_));
  tree_->setAlternatingRowColors(true);
  tree_->setUniformRowHeights(true);
  tree_->setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::EditKeyPressed |
                         QAbstractItemView::SelectedClicked);
  tree_->setContextMenuPolicy(Qt::CustomContextMenu);
  tree_->header()->setSectionResizeMode(ParameterModel::kName, QHeaderView::ResizeToContents);
  tree_->header()->setSectionResizeMode(ParameterModel::kValue, QHeaderView::Interactive);
  tree_->header()->setMinimumSectionSize(20);
  tree_->header()->resizeSection(ParameterModel::kValue, kValueWidth);
  tree_->header()->setStretchLastSection(false);
  tree_->header()->setSectionResizeMode(ParameterModel::kAllowed, QHeaderView::Stretch);
  tree_->setIndentation(kIndentation);
  tree_->setMinimumHeight(kLeastTreeRows * fontMetrics().lineSpacing());
  message_->setObjectName("sceneMessage");
  message_->setWordWrap(true);
  message_->setTextFormat(Qt::PlainText);
  message_->setMargin(4);
  message_->hide();
  slider_->setObjectName("parameterSlider");
  slider_->setRange(-kSliderSteps, kSliderSteps);
  slider_->setToolTip(
      tr("Moves the selected number, to half and to twice its value; everything follows"));
  slider_->setEnabled(false);
  slider_label_->setText(tr("Select a number to move it"));
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(2, 2, 2, 2);
  layout->addWidget(camera_);
  layout->addWidget(tree_, 1);
  layout->addWidget(message_);
  layout->addWidget(slider_label_);
  layout->addWidget(slider_);

  connect(tree_, &QTreeView::customContextMenuRequested, this, &ScenePanel::show_menu);
  connect(tree_->selectionModel(), &QItemSelectionModel::currentChanged, this, [this] {
    show_message();
    start_slider();
  });
  connect(model_, &ParameterModel::dataChanged, this, &ScenePanel::show_message);
  connect(model_, &ParameterModel::modelAboutToBeReset, this, &ScenePanel::remember_expanded);
  connect(model_, &ParameterModel::modelReset, this, &ScenePanel::restore_expanded);
  connect(slider_, &QSlider::valueChanged, this, &ScenePanel::move_slider);
  connect(slider_, &QSlider::sliderReleased, this, &ScenePanel::start_slider);
  connect(&document_, &Document::scene_changed, this, &ScenePanel::show_message);
  connect(&document_, &Document::issues_changed, this, [this] {
    show_message();
    reveal_unreadable();
  });
  connect(&document_, &Document::scene_changed, this, &ScenePanel::show_cameras);
  connect(camera_, QOverload<int>::of(&QComboBox::activated), this, [this](int chosen) {
    try {
      document_.choose_camera(camera_->itemData(chosen).toString().toStdString());
    } catch (const Error& error) {
      emit failed(QString::fromUtf8(error.what()));
    }
  });
}

void ScenePanel::show_cameras() {
  camera_->clear();
  for (const CameraSpec& camera : document_.scene().cameras) {
    const QString name = QString::fromStdString(camera.name);
    camera_->addItem(tr("Camera %1").arg(name), name);
    if (camera.name == document_.camera_name()) camera_->setCurrentIndex(camera_->count() - 1);
  }
  camera_->setVisible(camera_->count() > 1);
}

void ScenePanel::remember_expanded() {
  expanded_.clear();
  const std::function<void(const QModelIndex&)> visit = [&](const QModelIndex& parent) {
    for (int row = 0; row < model_->rowCount(parent); ++row) {
      const QModelIndex index = model_->index(row, 0, parent);
      if (!tree_->isExpanded(index)) continue;
      expanded_.insert(index.data(ParameterModel::kPathRole).toString());
      visit(index);
    }
  };
  visit({});
}

void ScenePanel::restore_expanded() {
  if (expanded_.empty())
    expanded_ = {"camera", "camera.focus", "cameras", "flames", "flames[0]", "render"};
  for (const QString& path : expanded_) {
    const QModelIndex index = model_->find(path.toStdString());
    if (index.isValid()) tree_->setExpanded(index, true);
  }
}

void ScenePanel::reveal(const QString& path) {
  const QModelIndex index = model_->find(path.toStdString(), ParameterModel::kValue);
  if (!index.isValid()) return;
  for (QModelIndex up = index.parent(); up.isValid(); up = up.parent()) tree_->expand(up);
  tree_->setCurrentIndex(index);
  tree_->scrollTo(index);
}

void ScenePanel::resizeEvent(QResizeEvent* event) {
  const bool narrow = width() < kWidePanel;
  tree_->setColumnHidden(ParameterModel::kAllowed, narrow);
  tree_->header()->setSectionResizeMode(ParameterModel::kValue,
                                        narrow ? QHeaderView::Stretch : QHeaderView::Interactive);
  QWidget::resizeEvent(event);
}

void ScenePanel::finish_editing() {
  if (tree_->isAncestorOf(QApplication::focusWidget())) tree_->setFocus();
}

/// Opens the value to view that names an unreadable file, without selecting it.
void ScenePanel::reveal_unreadable() {
  for (const SceneIssue& issue : document_.issues()) {
    if (!issue.is_error || issue.key.empty()) continue;
    const QModelIndex index = model_->find(issue.key);
    for (QModelIndex up = index.parent(); up.isValid(); up = up.parent()) tree_->expand(up);
    if (index.isValid()) tree_->scrollTo(index);
  }
}

void ScenePanel::show_message() {
  // The selected value's mistake comes first, otherwise the first thing that is wrong at all.
  const QModelIndex current = tree_->currentIndex();
  QString text;
  bool is_error = false;
  if (current.isValid()) {
    text = current.data(ParameterModel::kMessageRole).toString();
    is_error = current.data(ParameterModel::kIsErrorRole).toBool();
  }
  if (text.isEmpty())
    for (const SceneIssue& issue : document_.issues()) {
      if (!text.isEmpty() && (is_error || !issue.is_error)) continue;
      text = QString::fromStdString((issue.key.empty() ? "" : issue.key + ": ") + issue.message);
      is_error = issue.is_error;
    }
  message_->setText(text);
  message_->setVisible(!text.isEmpty());
  message_->setStyleSheet(is_error ? "background: #b3261e; color: white;"
                                   : "background: #e69f00; color: black;");
}

void ScenePanel::start_slider() {
  const QModelIndex current = tree_->currentIndex();
  const QString path = current.isValid() ? current.data(ParameterModel::kPathRole).toString() : "";
  const auto place = ParameterModel::place_of(path.toStdString());
  bool usable = place.key && (place.key->type == ValueType::number || place.component >= 0);
  if (usable) {
    const SchemaValue value = place.key->get(document_.scene(), parse_path(place.path).indices);
    if (place.component < 0) {
      slider_start_ = std::get<double>(value);
      slider_reach_ = 0;
      usable = slider_start_ != 0;
    } else {
      const std::vector<double> parts = components_of(value);
      slider_start_ = parts.at(static_cast<std::size_t>(place.component));
      double longest = 0;
      for (const double part : parts) longest = std::max(longest, std::fabs(part));
      slider_reach_ = longest > 0 && std::isfinite(longest) ? longest : kReachOfNothing;
    }
    usable = usable && std::isfinite(slider_start_);
  }
  slider_path_ = usable ? path : QString();
  ++stroke_;
  const bool was = slider_->blockSignals(true);
  slider_->setValue(0);
  slider_->blockSignals(was);
  slider_->setEnabled(usable);
  slider_label_->setText(usable ? path : tr("Select a number to move it"));
}

void ScenePanel::move_slider(int value) {
  if (slider_path_.isEmpty()) return;
  const auto place = ParameterModel::place_of(slider_path_.toStdString());
  if (!place.key) return;
  // Three digits are enough for a slider, and read well in the tree. A number goes to half and to
  // twice its value, a component by the length of its vector to both sides.
  const double share = double(value) / kSliderSteps;
  const double wanted = slider_reach_ > 0 ? slider_start_ + share * slider_reach_
                                          : slider_start_ * std::pow(kSliderFactor, share);
  const double of = slider_reach_ > 0 ? slider_reach_ : std::fabs(wanted);
  const double digits = std::pow(10.0, std::floor(std::log10(of)) - 3);
  const double rounded = value == 0 ? slider_start_ : std::round(wanted / digits) * digits;
  SchemaValue moved = rounded;
  std::string text;
  if (place.component >= 0) {
    // Written as the vector is, so that every component has its unit.
    const Vec3 of_parts{rounded, rounded, rounded};
    moved = place.key->type == ValueType::vector3 ? SchemaValue(of_parts)
                                                  : SchemaValue(Vec2{rounded, rounded});
    text = value_to_text(*place.key, moved);
    text = text.substr(0, text.find(','));
  } else {
    text = value_to_text(*place.key, moved);
  }
  const QModelIndex index = model_->find(slider_path_.toStdString(), ParameterModel::kValue);
  model_->set_value(index, QString::fromStdString(text),
                    slider_path_.toStdString() + " " + std::to_string(stroke_));
}

void ScenePanel::show_menu(const QPoint& place) {
  const QModelIndex index = tree_->indexAt(place).siblingAtColumn(0);
  if (!index.isValid()) return;
  QMenu menu(this);
  const auto guarded = [this](const std::function<void()>& act) {
    try {
      act();
    } catch (const Error& error) {
      emit failed(QString::fromUtf8(error.what()));
    }
  };
  const QString list = index.data(ParameterModel::kListRole).toString();
  const int item = index.data(ParameterModel::kItemRole).toInt();
  if (!list.isEmpty()) {
    menu.addAction(tr("Add an item"), this, [=, this] {
      guarded([&] {
        const std::string path = list.toStdString();
        document_.insert_item(path, item >= 0 ? static_cast<std::size_t>(item) + 1
                                              : list_size(document_.scene(), path));
      });
    });
    if (item >= 0)
      menu.addAction(tr("Remove this item"), this, [=, this] {
        guarded([&] { document_.erase_item(list.toStdString(), static_cast<std::size_t>(item)); });
      });
  }
  const ParsedPath parsed =
      parse_path(index.data(ParameterModel::kPathRole).toString().toStdString());
  int kind = index.data(ParameterModel::kPresetRole).toInt();
  if (list == "flames") kind = static_cast<int>(PresetKind::flame);
  if (kind >= 0) {
    QMenu* const presets = menu.addMenu(tr("Start from a preset"));
    for (const std::string& name : preset_names(static_cast<PresetKind>(kind))) {
      QAction* const action = presets->addAction(QString::fromStdString(name), this, [=, this] {
        guarded([&] {
          document_.apply_preset(
              static_cast<PresetKind>(kind), name,
              parsed.indices.empty() ? document_.scene().flames.size() : parsed.indices.front());
        });
      });
      action->setToolTip(
          QString::fromStdString(preset_description(static_cast<PresetKind>(kind), name)));
    }
    presets->setToolTipsVisible(true);
  }
  const SchemaKey* const key =
      find_schema_key(index.data(ParameterModel::kPathRole).toString().toStdString());
  if (key && !is_required(*key))
    menu.addAction(tr("Back to the default"), this, [=, this] {
      const std::string path = index.data(ParameterModel::kPathRole).toString().toStdString();
      guarded([&] { document_.set_value(path, value_to_text(*key, default_value(*key))); });
    });
  if (!menu.isEmpty()) menu.exec(tree_->viewport()->mapToGlobal(place));
}

}  // namespace plenoflame::desktop

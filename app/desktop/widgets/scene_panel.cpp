#include "widgets/scene_panel.h"

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
    if (index.column() == ParameterModel::kAllowed)
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
      tree_(new QTreeView(this)),
      message_(new QLabel(this)),
      slider_(new QSlider(Qt::Horizontal, this)),
      slider_label_(new QLabel(this)) {
  tree_->setObjectName("sceneTree");
  tree_->setModel(model_);
  tree_->setItemDelegate(new ValueDelegate(tree_));
  tree_->setAlternatingRowColors(true);
  tree_->setUniformRowHeights(true);
  tree_->setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::EditKeyPressed |
                         QAbstractItemView::SelectedClicked);
  tree_->setContextMenuPolicy(Qt::CustomContextMenu);
  tree_->header()->setSectionResizeMode(QHeaderView::Interactive);
  tree_->header()->resizeSection(0, 165);
  tree_->header()->resizeSection(1, 130);
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
  if (expanded_.empty()) expanded_ = {"camera", "camera.focus", "flames", "flames[0]", "render"};
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

void ScenePanel::show_message() {
  // What is wrong with the selected value, otherwise the first thing that is wrong at all.
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
  const SchemaKey* const key = path.isEmpty() ? nullptr : find_schema_key(path.toStdString());
  bool usable = key && key->type == ValueType::number;
  if (usable) {
    const ParsedPath parsed = parse_path(path.toStdString());
    slider_start_ = std::get<double>(key->get(document_.scene(), parsed.indices));
    usable = std::isfinite(slider_start_) && slider_start_ != 0;
  }
  slider_path_ = usable ? path : QString();
  const bool was = slider_->blockSignals(true);
  slider_->setValue(0);
  slider_->blockSignals(was);
  slider_->setEnabled(usable);
  slider_label_->setText(usable ? path : tr("Select a number to move it"));
}

void ScenePanel::move_slider(int value) {
  if (slider_path_.isEmpty()) return;
  const SchemaKey* const key = find_schema_key(slider_path_.toStdString());
  if (!key) return;
  // Three digits are enough for a slider, and read well in the tree.
  const double wanted = slider_start_ * std::pow(kSliderFactor, double(value) / kSliderSteps);
  const double digits = std::pow(10.0, std::floor(std::log10(std::fabs(wanted))) - 3);
  const double rounded = value == 0 ? slider_start_ : std::round(wanted / digits) * digits;
  const QModelIndex index = model_->find(slider_path_.toStdString(), ParameterModel::kValue);
  model_->setData(index, QString::fromStdString(value_to_text(*key, rounded)));
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
  int kind = index.data(ParameterModel::kPresetRole).toInt();
  if (list == "flames") kind = static_cast<int>(PresetKind::flame);
  if (kind >= 0) {
    QMenu* const presets = menu.addMenu(tr("Start from a preset"));
    for (const std::string& name : preset_names(static_cast<PresetKind>(kind))) {
      QAction* const action = presets->addAction(QString::fromStdString(name), this, [=, this] {
        guarded([&] {
          document_.apply_preset(
              static_cast<PresetKind>(kind), name,
              item >= 0 ? static_cast<std::size_t>(item) : document_.scene().flames.size());
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

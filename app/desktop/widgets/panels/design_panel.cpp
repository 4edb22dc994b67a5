#include "widgets/panels/design_panel.h"

#include <QEvent>
#include <QHeaderView>
#include <QLabel>
#include <QSplitter>
#include <QStyle>
#include <QTableWidget>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "widgets/controls/plot_widget.h"
#include "widgets/image/image_view.h"

namespace plenoflame::desktop {
namespace {

constexpr int kWarningsShown = 2;   ///< more of them are folded away at first
constexpr int kLeastRemark = 14;    ///< [characters] that the column of remarks is worth having for
constexpr int kLeastTableRows = 8;  ///< of the table that are seen at least

/// "102.8 mm wide, 16.62 mm behind" has its figure before the first comma, semicolon or bracket.
std::array<QString, 2> value_and_remark(const QString& text) {
  int end = text.size();
  for (const char* mark : {", ", "; ", " (", ": "}) {
    const int at = text.indexOf(mark);
    if (at > 0) end = std::min(end, at);
  }
  QString rest = text.mid(end);
  if (rest.startsWith(", ") || rest.startsWith("; ") || rest.startsWith(": ")) rest = rest.mid(2);
  return {text.left(end), rest.trimmed()};
}

}  // namespace

DesignPanel::DesignPanel(DesignJob& job, QWidget* parent)
    : QWidget(parent),
      job_(job),
      table_(new QTableWidget(0, 3, this)),
      fold_(new QToolButton(this)),
      warnings_(new QLabel(this)),
      resolution_(new PlotWidget(this)) {
  table_->setObjectName("designTable");
  table_->setHorizontalHeaderLabels({tr("Figure"), tr("Value"), tr("Remark")});
  table_->verticalHeader()->setVisible(false);
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::Fixed);
  table_->setWordWrap(true);
  table_->setMinimumHeight(kLeastTableRows * (fontMetrics().height() + 6));
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->setAlternatingRowColors(true);
  table_->setToolTip(
      tr("What `plenoflame design` says about this camera; it "
         "follows every change"));
  // Columns follow the width, which must not depend on what becomes of them.
  table_->setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOn);
  table_->viewport()->installEventFilter(this);
  warnings_->setObjectName("designWarnings");
  warnings_->setWordWrap(true);
  warnings_->setMargin(4);
  warnings_->setStyleSheet("background: #e69f00; color: black;");
  warnings_->hide();
  resolution_->setObjectName("resolutionPlot");
  resolution_->setMinimumHeight(150);
  resolution_->set_axes(tr("object distance [m]"), tr("effective resolution"), false, false);
  resolution_->set_empty_text(
      tr("Effective resolution appears for cameras with a microlens array."));
  resolution_->setToolTip(
      tr("Effective resolution of each microlens type "
         "against the object's distance: by rays solid, "
         "paraxial dashed"));
  auto* split = new QSplitter(Qt::Vertical, this);
  split->addWidget(table_);
  split->addWidget(resolution_);
  split->setStretchFactor(0, 3);
  split->setStretchFactor(1, 2);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(2, 2, 2, 2);
  fold_->setObjectName("designWarningsFold");
  fold_->setCheckable(true);
  fold_->setAutoRaise(true);
  fold_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  fold_->setToolTip(tr("Shows the warnings, or hides them"));
  fold_->hide();
  connect(fold_, &QToolButton::toggled, this, &DesignPanel::show_fold);
  layout->addWidget(fold_);
  layout->addWidget(warnings_);
  layout->addWidget(split, 1);
  connect(&job_, &DesignJob::result_changed, this, &DesignPanel::fill);
}

/// Puts remarks below their values if there is no room for three columns.
void DesignPanel::fit_columns() {
  const int room = table_->viewport()->width();
  const QFontMetrics metrics = fontMetrics();
  const int margins = 4 * table_->style()->pixelMetric(QStyle::PM_FocusFrameHMargin) + 6;
  int figure = table_->horizontalHeader()->sectionSizeHint(0),
      value = table_->horizontalHeader()->sectionSizeHint(1);
  for (const auto& row : rows_) {
    figure = std::max(figure, metrics.horizontalAdvance(row[0]) + margins);
    value = std::max(value, metrics.horizontalAdvance(row[1]) + margins);
  }
  const int rest = room - figure - value;
  const bool narrow = rest < kLeastRemark * metrics.averageCharWidth();
  table_->setColumnHidden(2, narrow);
  for (int i = 0; i < static_cast<int>(rows_.size()); ++i) {
    const auto& row = rows_[static_cast<std::size_t>(i)];
    QTableWidgetItem* const item = table_->item(i, 1);
    if (item) item->setText(narrow && !row[2].isEmpty() ? row[1] + "\n" + row[2] : row[1]);
  }
  if (narrow) figure = room - std::max(room - figure, std::min(value, room / 2));
  table_->setColumnWidth(0, figure);
  table_->setColumnWidth(1, narrow ? room - figure : value);
  if (!narrow) table_->setColumnWidth(2, rest);
  table_->resizeRowsToContents();
}

bool DesignPanel::eventFilter(QObject* object, QEvent* event) {
  if (object == table_->viewport() && event->type() == QEvent::Resize) fit_columns();
  return QWidget::eventFilter(object, event);
}

void DesignPanel::show_fold() {
  fold_->setText(shown_count_ == 1 ? tr("1 warning") : tr("%1 warnings").arg(shown_count_));
  fold_->setArrowType(fold_->isChecked() ? Qt::DownArrow : Qt::RightArrow);
  warnings_->setVisible(fold_->isChecked() && shown_count_ > 0);
}

void DesignPanel::fill() {
  const auto result = job_.result();
  if (!result) return;
  const auto rows = static_cast<int>(result->lines.size());
  table_->setRowCount(rows);
  rows_.resize(static_cast<std::size_t>(rows));
  for (int i = 0; i < rows; ++i) {
    const auto& [label, text] = result->lines[static_cast<std::size_t>(i)];
    const auto [value, remark] = value_and_remark(QString::fromStdString(text));
    const std::array<QString, 3> texts{QString::fromStdString(label), value, remark};
    rows_[static_cast<std::size_t>(i)] = texts;
    for (int k = 0; k < 3; ++k) {
      QTableWidgetItem* item = table_->item(i, k);
      if (!item) {
        item = new QTableWidgetItem;
        table_->setItem(i, k, item);
      }
      item->setText(texts[static_cast<std::size_t>(k)]);
      if (k > 0) item->setToolTip(QString::fromStdString(text));
    }
  }
  warnings_->setText(result->warnings.join("\n"));
  fit_columns();
  const int count = result->warnings.size();
  fold_->setVisible(count > 0);
  if (count != shown_count_) fold_->setChecked(count <= kWarningsShown);
  shown_count_ = count;
  show_fold();
  if (!result->complete) return;  // rays are still being traced: the old curves stay so long
  std::vector<PlotWidget::Series> series;
  for (std::size_t k = 0; k < result->figures.types.size(); ++k) {
    PlotWidget::Series traced, paraxial;
    traced.name = QString::fromStdString(result->figures.types[k].name);
    traced.colour = paraxial.colour = type_colour(static_cast<int>(k));
    paraxial.dashed = true;
    for (const ResolutionPoint& p : result->resolution) {
      traced.points << QPointF(p.object_distance, p.traced[k]);
      paraxial.points << QPointF(p.object_distance, p.paraxial[k]);
    }
    series.push_back(std::move(paraxial));
    series.push_back(std::move(traced));
  }
  resolution_->set_series(std::move(series));
}

}  // namespace plenoflame::desktop

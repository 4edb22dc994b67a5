#include "widgets/design_panel.h"

#include <QHeaderView>
#include <QLabel>
#include <QSplitter>
#include <QTableWidget>
#include <QVBoxLayout>
#include <cmath>
#include <utility>

#include "widgets/image_view.h"
#include "widgets/plot_widget.h"

namespace plenoflame::desktop {

DesignPanel::DesignPanel(DesignJob& job, QWidget* parent)
    : QWidget(parent),
      job_(job),
      table_(new QTableWidget(0, 2, this)),
      warnings_(new QLabel(this)),
      resolution_(new PlotWidget(this)) {
  table_->setObjectName("designTable");
  table_->setHorizontalHeaderLabels({tr("Figure"), tr("Value")});
  table_->verticalHeader()->setVisible(false);
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  table_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
  table_->horizontalHeader()->setStretchLastSection(true);
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->setAlternatingRowColors(true);
  table_->setToolTip(
      tr("What `plenoflame design` says about this camera; it follows every change"));
  warnings_->setObjectName("designWarnings");
  warnings_->setWordWrap(true);
  warnings_->setMargin(4);
  warnings_->setStyleSheet("background: #e69f00; color: black;");
  warnings_->hide();
  resolution_->setObjectName("resolutionPlot");
  resolution_->set_axes(tr("object distance [m]"), tr("pixels kept along an axis"), false, false);
  resolution_->set_empty_text(
      tr("Effective resolution appears for cameras with a microlens array."));
  resolution_->setToolTip(tr(
      "Effective resolution of each microlens type against the object's distance: by rays solid, "
      "paraxial dashed"));
  auto* split = new QSplitter(Qt::Vertical, this);
  split->addWidget(table_);
  split->addWidget(resolution_);
  split->setStretchFactor(0, 3);
  split->setStretchFactor(1, 2);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(2, 2, 2, 2);
  layout->addWidget(warnings_);
  layout->addWidget(split, 1);
  connect(&job_, &DesignJob::result_changed, this, &DesignPanel::fill);
}

void DesignPanel::fill() {
  const auto result = job_.result();
  if (!result) return;
  const auto rows = static_cast<int>(result->lines.size());
  table_->setRowCount(rows);
  for (int i = 0; i < rows; ++i) {
    const auto& [label, text] = result->lines[static_cast<std::size_t>(i)];
    const std::array<QString, 2> texts{QString::fromStdString(label), QString::fromStdString(text)};
    for (int k = 0; k < 2; ++k) {
      QTableWidgetItem* item = table_->item(i, k);
      if (!item) {
        item = new QTableWidgetItem;
        table_->setItem(i, k, item);
      }
      item->setText(texts[static_cast<std::size_t>(k)]);
      if (k == 1) item->setToolTip(texts[1]);
    }
  }
  warnings_->setText(result->warnings.join("\n"));
  warnings_->setVisible(!result->warnings.isEmpty());
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

#include "widgets/panels/rays_panel.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QScrollBar>
#include <QSplitter>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <array>
#include <cmath>

#include "plenoflame/base/units.h"
#include "widgets/scene/section_view.h"

namespace plenoflame::desktop {
namespace {

constexpr int kEndedColumn = 2;
constexpr int kLettersOfCut = 9;  ///< that a column has room for whose long texts are cut
constexpr int kRows = 3;          ///< that are seen at least
/// Columns that a narrow panel leaves out, first to last: the lines' tooltips show them.
constexpr std::array<int, 7> kRaysLeaveOut{1, 5, 8, 4, 6, 3, 7};
constexpr std::array<int, 3> kSurfacesLeaveOut{3, 4, 2};

QString quantity(double value, Dimension dimension) {
  return std::isfinite(value) ? QString::fromStdString(readable_quantity(value, dimension))
                              : QString::fromUtf8("\xe2\x80\x93");
}

int row_height(const QFontMetrics& letters) {
  return letters.height() + 2;
}

QTableWidget* make_table(const QStringList& headers, const QStringList& tips, QWidget* parent) {
  auto* table = new QTableWidget(0, headers.size(), parent);
  table->setHorizontalHeaderLabels(headers);
  for (int i = 0; i < tips.size(); ++i) table->horizontalHeaderItem(i)->setToolTip(tips[i]);
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setSelectionMode(QAbstractItemView::SingleSelection);
  table->setAlternatingRowColors(true);
  table->setTextElideMode(Qt::ElideMiddle);  // ends tell lens surfaces apart
  table->verticalHeader()->setVisible(false);
  table->verticalHeader()->setMinimumSectionSize(1);  // the style's would be higher than letters
  table->verticalHeader()->setDefaultSectionSize(row_height(table->fontMetrics()));
  table->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table->horizontalHeader()->setHighlightSections(false);  // bold names would be wider
  table->setMinimumHeight(2 * table->fontMetrics().height() + 8 +
                          kRows * row_height(table->fontMetrics()));
  return table;
}

/// Shows as many columns as are whole in the table's width. @param cut column whose long texts may
/// be cut; -1: none
template <std::size_t Count>
void fit(QTableWidget& table, const std::array<int, Count>& leave_out, int cut = -1) {
  int width = 2 * table.frameWidth() + table.verticalScrollBar()->sizeHint().width() + 2;
  for (int i = 0; i < table.columnCount(); ++i) {
    table.setColumnHidden(i, false);
    const int texts = static_cast<const QAbstractItemView&>(table).sizeHintForColumn(i);
    const int most = kLettersOfCut * table.fontMetrics().averageCharWidth();
    width += std::max(table.horizontalHeader()->sectionSizeHint(i),
                      i == cut ? std::min(texts, most) : texts);
  }
  for (const int column : leave_out) {
    if (width <= table.width()) return;
    width -= table.columnWidth(column);
    table.setColumnHidden(column, true);
  }
}

/// A line of a table; each of its places says all of it.
void fill_line(QTableWidget& table, int line, const QStringList& texts) {
  QStringList all;
  for (int k = 0; k < texts.size(); ++k)
    all << QString(table.horizontalHeaderItem(k)->text()).replace('\n', ' ') + ": " + texts[k];
  for (int k = 0; k < texts.size(); ++k) {
    auto* item = new QTableWidgetItem(texts[k]);
    item->setToolTip(all.join('\n'));
    table.setItem(line, k, item);
  }
}

}  // namespace

RaysPanel::RaysPanel(RaySelector& rays, QWidget* parent)
    : QWidget(parent),
      rays_(rays),
      title_(new QLabel(this)),
      split_(new QSplitter(Qt::Vertical, this)) {
  table_ = make_table(
      {tr("Ray"), tr("Pixel"), tr("Ended"), tr("Microlens"), tr("Angle\nat sensor"),
       tr("Angle\nin scene"), tr("Optical\nthickness"), tr("Radiance\n[W/(m\302\262 sr)]"),
       tr("Weight\n[m\302\262 sr]")},
      {tr("Number of the ray"),
       tr("Column and row of the pixel that it belongs to; double click or Return selects it"),
       tr("How it ended, and where"), tr("Type and place (q, r) of its microlens"),
       tr("Between ray and optical axis at the sensor"),
       tr("Between ray and optical axis in front of the camera"),
       tr("Of the flames along the ray; 1 takes 63 % of the light from behind"),
       tr("That it brings to the camera, first channel [W/(m\302\262 sr)]"),
       tr("Share of the pixel's etendue [m\302\262 sr]; times radiance, summed "
          "over the rays: the pixel's flux")},
      split_);
  table_->setObjectName("raysTable");
  table_->horizontalHeader()->setSectionResizeMode(kEndedColumn, QHeaderView::Stretch);
  surfaces_ = make_table({tr("Surface"), tr("Distance"), tr("Height"), tr("Angle"), tr("Index")},
                         {tr("What it meets, in order"), tr("Along the ray from its start"),
                          tr("From the optical axis"), tr("With the axis, behind the surface"),
                          tr("Refractive index behind the surface")},
                         split_);
  surfaces_->setObjectName("surfacesTable");
  surfaces_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
  split_->addWidget(table_);
  split_->addWidget(surfaces_);
  split_->setStretchFactor(0, 2);
  split_->setStretchFactor(1, 1);
  split_->setSizes({200, 100});
  title_->setObjectName("raysTitle");
  title_->setWordWrap(true);
  title_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  export_ = new QPushButton(tr("Export rays..."), this);
  export_->setObjectName("exportRays");
  export_->setToolTip(tr("Write these rays as .vtp (ParaView), .csv or .json"));
  export_->setEnabled(false);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 2, 4, 2);
  layout->addWidget(title_);
  layout->addWidget(split_, 1);
  layout->addWidget(export_, 0, Qt::AlignRight);
  connect(&rays_, &RaySelector::rays_changed, this, &RaysPanel::fill);
  connect(table_, &QTableWidget::currentCellChanged, this, [this] {
    fill_surfaces(chosen());
    emit ray_chosen(chosen());
  });
  connect(table_, &QTableWidget::cellActivated, this, [this](int row) {
    const auto shown = rays_.rays();
    const auto number = static_cast<std::size_t>(table_->item(row, 0)->data(Qt::UserRole).toInt());
    if (!shown || number >= shown->paths.rays.size()) return;
    const RayPath& ray = shown->paths.rays[number];
    if (ray.column >= 0) emit pixel_requested(ray.column, ray.row);
  });
  connect(export_, &QPushButton::clicked, this, &RaysPanel::export_requested);
  fill();
}

void RaysPanel::fill() {
  const auto rays = rays_.rays();
  export_->setEnabled(rays != nullptr);
  const bool quiet = table_->blockSignals(true);
  table_->setRowCount(0);
  surfaces_->setRowCount(0);
  if (!rays) {
    title_->setText(
        tr("Click a pixel to see its rays; Shift+click for its microlens; a point of the flame for "
           "the "
           "pixels that see it."));
    table_->blockSignals(quiet);
    return;
  }
  const std::vector<RayRow> rows = ray_rows(*rays);
  table_->setRowCount(static_cast<int>(rows.size()));
  for (int i = 0; i < static_cast<int>(rows.size()); ++i) {
    const RayRow& row = rows[static_cast<std::size_t>(i)];
    const QStringList texts{
        QString::number(row.ray + 1),
        row.column < 0 ? QString() : QString("%1, %2").arg(row.column).arg(row.row),
        row.status,
        row.microlens,
        quantity(row.angle, Dimension::angle),
        quantity(row.scene_angle, Dimension::angle),
        QString::number(row.optical_thickness, 'g', 4),
        QString::number(row.radiance, 'g', 4),
        QString::number(row.weight, 'g', 4)};
    fill_line(*table_, i, texts);
    for (int k = 0; k < texts.size(); ++k) table_->item(i, k)->setData(Qt::UserRole, row.ray);
  }
  colour_endings();
  show_title();
  // The first one that has something to show.
  const auto reached = std::find_if(rows.begin(), rows.end(), [&](const RayRow& row) {
    return rays->paths.rays[static_cast<std::size_t>(row.ray)].status.status == RayStatus::reached;
  });
  if (!rows.empty())
    table_->setCurrentCell(reached == rows.end() ? 0 : static_cast<int>(reached - rows.begin()), 0);
  table_->blockSignals(quiet);
  fill_surfaces(chosen());
}

void RaysPanel::set_pixel_of_picture(const QString& text) {
  if (text == pixel_of_picture_) return;
  pixel_of_picture_ = text;
  if (rays_.rays()) show_title();
}

void RaysPanel::show_title() {
  const auto rays = rays_.rays();
  const std::vector<RayRow> rows = ray_rows(*rays);
  double flux = 0;
  for (const RayRow& row : rows) flux += row.weight * row.radiance;
  const Selection& selection = rays->selection;
  QString text;
  switch (selection.kind) {
    case Selection::Kind::pixel:
      text = tr("Pixel %1, %2: %3 rays, flux %4")
                 .arg(selection.column)
                 .arg(selection.row)
                 .arg(rows.size())
                 .arg(quantity(flux, Dimension::flux));
      // Both are estimates of one flux, from rays of their own number.
      if (!pixel_of_picture_.isEmpty()) text += tr("; %1").arg(pixel_of_picture_);
      break;
    case Selection::Kind::microlens:
      text = tr("Microlens (%1, %2): %3 pixels, %4 of its rays")
                 .arg(selection.lens.q)
                 .arg(selection.lens.r)
                 .arg(rays->pixels.size())
                 .arg(rows.size());
      break;
    default:
      text = tr("Point %1, %2, %3: seen by %4 pixels")
                 .arg(quantity(selection.point.x, Dimension::length),
                      quantity(selection.point.y, Dimension::length),
                      quantity(selection.point.z, Dimension::length))
                 .arg(rays->pixels.size());
  }
  title_->setText(text);
}

void RaysPanel::fit_tables() {
  fit(*table_, kRaysLeaveOut, kEndedColumn);
  fit(*surfaces_, kSurfacesLeaveOut);
}

void RaysPanel::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  fit_tables();
}

/// The colours that the rays have in the views, as they read on this theme.
void RaysPanel::colour_endings() {
  const auto rays = rays_.rays();
  if (!rays) return;
  const bool dark = palette().color(QPalette::Base).lightness() < 128;
  for (int i = 0; i < table_->rowCount(); ++i) {
    QTableWidgetItem* const item = table_->item(i, kEndedColumn);
    if (!item) continue;
    const auto ray = static_cast<std::size_t>(item->data(Qt::UserRole).toInt());
    if (ray < rays->paths.rays.size())
      item->setForeground(status_colour(rays->paths.rays[ray].status.status, dark));
  }
}

void RaysPanel::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange) colour_endings();
}

int RaysPanel::chosen() const {
  const QTableWidgetItem* const item = table_->item(table_->currentRow(), 0);
  return item ? item->data(Qt::UserRole).toInt() : -1;
}

void RaysPanel::fill_surfaces(int ray) {
  const auto rays = rays_.rays();
  surfaces_->setRowCount(0);
  if (!rays || ray < 0) return;
  const auto rows = ray_surfaces(*rays, static_cast<std::size_t>(ray));
  surfaces_->setRowCount(static_cast<int>(rows.size()));
  for (int i = 0; i < static_cast<int>(rows.size()); ++i) {
    const RaySurfaceRow& row = rows[static_cast<std::size_t>(i)];
    const QStringList texts{row.surface, quantity(row.distance, Dimension::length),
                            quantity(row.height, Dimension::length),
                            quantity(row.angle, Dimension::angle),
                            QString::number(row.index, 'g', 5)};
    fill_line(*surfaces_, i, texts);
  }
  fit_tables();
}

}  // namespace plenoflame::desktop

#include "widgets/image/light_field_panel.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QMouseEvent>
#include <QPainter>
#include <QProxyStyle>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>
#include <QSpinBox>
#include <QTabBar>
#include <QTabWidget>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/lightfield/develop.h"
#include "plenoflame/lightfield/refocus.h"
#include "widgets/controls/glyphs.h"
#include "widgets/controls/notice.h"
#include "widgets/controls/pointer.h"
#include "widgets/image/image_view.h"

namespace plenoflame::desktop {
namespace {

/// Tabs with less room beside their texts, so that all of them are read in a small window.
class NarrowTabs : public QProxyStyle {
 public:
  using QProxyStyle::QProxyStyle;
  int pixelMetric(PixelMetric metric, const QStyleOption* option,
                  const QWidget* widget) const override {
    const int usual = QProxyStyle::pixelMetric(metric, option, widget);
    return metric == PM_TabBarTabHSpace ? usual / 2 : usual;
  }
};

constexpr int kDepthSteps = 400;

QString length_text(double value) {
  return QString::fromStdString(readable_quantity(value, Dimension::length));
}

ImageView* make_view(QWidget* parent, const char* name) {
  auto* view = new ImageView(parent);
  view->setObjectName(name);
  view->set_value_format(Dimension::radiance);
  ToneSettings tone;
  tone.map = ColourMap::inferno;
  view->set_tone(tone);
  return view;
}

}  // namespace

AperturePad::AperturePad(int grid, QWidget* parent)
    : QWidget(parent), grid_(grid), column_(grid / 2), row_(grid / 2) {
  setMinimumSize(90, 90);
  setMaximumHeight(170);
  setFocusPolicy(Qt::StrongFocus);
}

QRectF AperturePad::disc() const {
  const double side = std::min(width(), height()) - 8.0;
  return {0.5 * (width() - side), 0.5 * (height() - side), side, side};
}

void AperturePad::set_place(int column, int row) {
  column = std::clamp(column, 0, grid_ - 1);
  row = std::clamp(row, 0, grid_ - 1);
  if (column == column_ && row == row_) return;
  column_ = column;
  row_ = row;
  update();
  emit moved(column_, row_);
}

void AperturePad::move_to(QPointF place) {
  const QRectF area = disc();
  // The views' square lies within the stop: 0.7 of its diameter.
  const double side = 0.7 * area.width();
  const double u = (place.x() - area.center().x()) / side + 0.5,
               v = (place.y() - area.center().y()) / side + 0.5;
  set_place(static_cast<int>(std::floor(u * grid_)), static_cast<int>(std::floor(v * grid_)));
}

void AperturePad::mousePressEvent(QMouseEvent* event) {
  move_to(pointer_place(event));
}

void AperturePad::mouseMoveEvent(QMouseEvent* event) {
  if ((event->buttons() & Qt::LeftButton) != 0) move_to(pointer_place(event));
}

void AperturePad::keyPressEvent(QKeyEvent* event) {
  switch (event->key()) {
    case Qt::Key_Left:
      return set_place(column_ - 1, row_);
    case Qt::Key_Right:
      return set_place(column_ + 1, row_);
    case Qt::Key_Up:
      return set_place(column_, row_ - 1);
    case Qt::Key_Down:
      return set_place(column_, row_ + 1);
    default:
      QWidget::keyPressEvent(event);
  }
}

void AperturePad::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  const QRectF area = disc();
  painter.setPen(QPen(palette().color(hasFocus() ? QPalette::Highlight : QPalette::Mid), 2));
  painter.setBrush(palette().color(QPalette::Base));
  painter.drawEllipse(area);
  const double step = 0.7 * area.width() / grid_;
  const QPointF corner = area.center() - QPointF(0.35 * area.width(), 0.35 * area.width());
  for (int row = 0; row < grid_; ++row)
    for (int column = 0; column < grid_; ++column) {
      const bool here = column == column_ && row == row_;
      painter.setPen(Qt::NoPen);
      painter.setBrush(palette().color(here ? QPalette::Highlight : QPalette::Mid));
      const double radius = here ? 5.5 : 1.8;
      painter.drawEllipse(corner + QPointF((column + 0.5) * step, (row + 0.5) * step), radius,
                          radius);
    }
}

LightFieldPanel::LightFieldPanel(Document& document, LightFieldJobs& jobs, QWidget& picture,
                                 QWidget& reconstruction, QWidget* parent)
    : QWidget(parent), document_(document), jobs_(jobs), tabs_(new QTabWidget(this)) {
  setObjectName("lightFieldPanel");
  tabs_->setObjectName("lightFieldTabs");
  tabs_->setDocumentMode(true);
  auto* const narrow = new NarrowTabs("fusion");
  narrow->setParent(tabs_);
  tabs_->tabBar()->setStyle(narrow);
  tabs_->setUsesScrollButtons(false);
  tabs_->setElideMode(Qt::ElideRight);
  tabs_->addTab(&picture, tr("Light field"));
  tabs_->addTab(make_views_tab(), tr("Views"));
  tabs_->addTab(make_refocus_tab(), tr("Refocus"));
  tabs_->addTab(make_total_tab(), tr("Total focus"));
  tabs_->addTab(make_epipolar_tab(), tr("Slice"));
  tabs_->addTab(&reconstruction, tr("Reconstruction"));
  auto* save = new QToolButton(tabs_);
  save->setObjectName("exportDerived");
  save->setIcon(glyph_icon(Glyph::picture));
  save->setAutoRaise(true);
  save->setToolTip(tr("Write what is shown as .png, or its values as .exr"));
  tabs_->setCornerWidget(save);
  connect(save, &QToolButton::clicked, this, &LightFieldPanel::export_requested);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  notice_ = new Notice(this);
  notice_->setObjectName("lightFieldNotice");
  layout->addWidget(notice_);
  layout->addWidget(tabs_, 1);
  connect(&jobs_, &LightFieldJobs::views_changed, this, &LightFieldPanel::on_views_changed);
  connect(&jobs_, &LightFieldJobs::refocused_changed, this, &LightFieldPanel::show_refocused);
  connect(&jobs_, &LightFieldJobs::stack_changed, this, &LightFieldPanel::show_stack);
  connect(tabs_, &QTabWidget::currentChanged, this, [this] {
    if (shows_views()) emit views_wanted();
    if (tab() == Tab::refocus) request_refocus();
    if (tab() == Tab::slice) show_slice();
  });
  connect(&document_, &Document::image_changed, this, [this] {
    if (!jobs_.views()) on_views_changed();
  });
  on_views_changed();
}

LightFieldPanel::Tab LightFieldPanel::tab() const {
  return static_cast<Tab>(tabs_->currentIndex());
}

void LightFieldPanel::show_tab(Tab tab) {
  tabs_->setCurrentIndex(static_cast<int>(tab));
}

QWidget* LightFieldPanel::make_views_tab() {
  auto* page = new QWidget(this);
  pad_ = new AperturePad(LightFieldJobs::kGrid, page);
  pad_->setObjectName("aperturePad");
  pad_->setToolTip(
      tr("The stop of the main lens, seen from behind the camera: drag the point that the scene is "
         "seen "
         "from; arrow keys move it, too"));
  view_ = make_view(page, "subApertureView");
  view_label_ = new QLabel(page);
  view_label_->setWordWrap(true);
  type_ = new QComboBox(page);
  type_->setObjectName("viewType");
  type_->setToolTip(
      tr("Which microlenses the views are made of: all, or those of one type, whose lattice is "
         "coarser"));
  type_->hide();
  auto* layout = new QVBoxLayout(page);
  layout->setContentsMargins(2, 2, 2, 2);
  layout->addWidget(pad_);
  layout->addWidget(type_);
  layout->addWidget(view_label_);
  layout->addWidget(view_, 1);
  connect(pad_, &AperturePad::moved, this, &LightFieldPanel::show_view);
  connect(type_, QOverload<int>::of(&QComboBox::activated), this,
          [this](int chosen) { jobs_.set_view_type(chosen - 1); });
  return page;
}

QWidget* LightFieldPanel::make_refocus_tab() {
  auto* page = new QWidget(this);
  depth_ = new QSlider(Qt::Horizontal, page);
  depth_->setObjectName("depthSlider");
  depth_->setRange(0, kDepthSteps);
  depth_->setToolTip(tr("Distance of the plane in focus from the front of the main lens"));
  depth_edit_ = new QLineEdit(page);
  depth_edit_->setObjectName("depthEdit");
  depth_edit_->setMaximumWidth(100);
  depth_edit_->setToolTip(tr("The same as a number with its unit, e.g. 1.2 m"));
  aperture_ = new QSlider(Qt::Horizontal, page);
  aperture_->setRange(5, 100);
  aperture_->setValue(100);
  aperture_->setToolTip(
      tr("Diameter of the synthetic lens, as a share of the main lens' stop: less of it, more is "
         "sharp"));
  refocused_ = make_view(page, "refocusedView");
  refocus_label_ = new QLabel(page);
  refocus_label_->setWordWrap(true);
  auto* row = new QHBoxLayout;
  row->addWidget(new QLabel(tr("Depth"), page));
  row->addWidget(depth_, 1);
  row->addWidget(depth_edit_);
  auto* second = new QHBoxLayout;
  second->addWidget(new QLabel(tr("Aperture"), page));
  second->addWidget(aperture_, 1);
  auto* layout = new QVBoxLayout(page);
  layout->setContentsMargins(2, 2, 2, 2);
  layout->addLayout(row);
  layout->addLayout(second);
  layout->addWidget(refocus_label_);
  layout->addWidget(refocused_, 1);
  connect(depth_, &QSlider::valueChanged, this, [this] {
    // Equal steps of 1 / depth: as the focus of a lens moves.
    const double t = static_cast<double>(depth_->value()) / kDepthSteps;
    depth_wanted_ = 1 / ((1 - t) / nearest_ + t / farthest_);
    depth_edit_->setText(length_text(depth_wanted_));
    depth_edit_->setStyleSheet({});
    request_refocus();
  });
  connect(aperture_, &QSlider::valueChanged, this, &LightFieldPanel::request_refocus);
  connect(depth_edit_, &QLineEdit::editingFinished, this, [this] {
    if (!depth_edit_->isModified()) return;  // the present text is rounded
    depth_edit_->setStyleSheet({});
    try {
      const double depth = parse_quantity(depth_edit_->text().toStdString(), Dimension::length);
      if (jobs_.micro_images()) check_refocus_depth(jobs_.micro_images()->camera(), depth);
      set_depth(depth);
    } catch (const Error& error) {
      depth_edit_->setStyleSheet("QLineEdit { background: #b3261e; color: white; }");
      refocus_label_->setText(QString::fromUtf8(error.what()));
    }
  });
  return page;
}

QWidget* LightFieldPanel::make_total_tab() {
  auto* page = new QWidget(this);
  auto* start = new QPushButton(tr("Compute"), page);
  start->setObjectName("totalFocus");
  start->setToolTip(
      tr("Refocus on several depths and take of each place the one where it is sharp"));
  planes_ = new QSpinBox(page);
  planes_->setRange(3, 41);
  planes_->setValue(9);
  planes_->setToolTip(tr("Number of depths, over the range of the refocus slider"));
  total_kind_ = new QComboBox(page);
  total_kind_->addItems({tr("All in focus"), tr("Depth")});
  total_kind_->setToolTip(
      tr("The picture, or the depth at which each place is sharp (opaque scenes; a flame is "
         "transparent and has no single depth)"));
  total_ = make_view(page, "totalFocusView");
  total_label_ = new QLabel(tr("A stack of depths takes some seconds."), page);
  total_label_->setWordWrap(true);
  auto* row = new QHBoxLayout;
  row->addWidget(start);
  row->addWidget(planes_);
  row->addWidget(new QLabel(tr("depths"), page));
  row->addStretch(1);
  row->addWidget(total_kind_);
  auto* layout = new QVBoxLayout(page);
  layout->setContentsMargins(2, 2, 2, 2);
  layout->addLayout(row);
  layout->addWidget(total_label_);
  layout->addWidget(total_, 1);
  connect(start, &QPushButton::clicked, this, [this] {
    total_label_->setText(tr("computing..."));
    jobs_.total_focus(nearest_, farthest_, planes_->value());
  });
  connect(total_kind_, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
          &LightFieldPanel::show_stack);
  return page;
}

QWidget* LightFieldPanel::make_epipolar_tab() {
  auto* page = new QWidget(this);
  line_ = new QSlider(Qt::Horizontal, page);
  line_->setObjectName("lineSlider");
  line_->setToolTip(tr("Row (or column) of the views that is cut out"));
  slice_direction_ = new QComboBox(page);
  slice_direction_->setObjectName("sliceDirection");
  slice_direction_->addItems({tr("Row"), tr("Column")});
  slice_direction_->setToolTip(
      tr("Along a row as the viewpoint moves across, or a column as it moves down"));
  slice_ = make_view(page, "epipolarView");
  slice_label_ = new QLabel(page);
  slice_label_->setWordWrap(true);
  auto* row = new QHBoxLayout;
  row->addWidget(slice_direction_);
  row->addWidget(line_, 1);
  auto* layout = new QVBoxLayout(page);
  layout->setContentsMargins(2, 2, 2, 2);
  layout->addLayout(row);
  layout->addWidget(slice_label_);
  layout->addWidget(slice_, 1);
  connect(line_, &QSlider::valueChanged, this, &LightFieldPanel::show_slice);
  connect(slice_direction_, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
          &LightFieldPanel::on_views_changed);
  return page;
}

void LightFieldPanel::set_notice(const QString& failure, bool old) {
  notice_->say(failure, Notice::Kind::error);
  for (ImageView* view : {view_, refocused_, slice_, total_})
    view->set_badge(old ? tr("older than the last change") : QString());
}

void LightFieldPanel::set_depth(double depth) {
  if (!(depth > 0) || !std::isfinite(depth))
    throw InputError("a depth is a distance in front of the lens, above 0");
  place_depth(depth);
  request_refocus();
}

/// The slider stands at the nearest of its steps; its range grows where it must.
void LightFieldPanel::place_depth(double depth) {
  depth_wanted_ = depth;
  nearest_ = std::min(nearest_, depth);
  farthest_ = std::max(farthest_, depth);
  const double t = (1 / nearest_ - 1 / depth) / (1 / nearest_ - 1 / farthest_);
  const QSignalBlocker quiet(depth_);
  depth_->setValue(static_cast<int>(std::lround(t * kDepthSteps)));
  depth_edit_->setText(length_text(depth));
}

void LightFieldPanel::request_refocus() {
  if (depth_wanted_ > 0) jobs_.refocus(depth_wanted_, aperture_->value() / 100.0);
}

void LightFieldPanel::show(ImageView& view, std::shared_ptr<const Image> image, double white,
                           bool is_depth) {
  if (!image) {
    view.set_image(nullptr);
    return;
  }
  ToneSettings tone = view.tone_settings();
  tone.white = white > 0 ? white : 1;
  tone.map = is_depth ? ColourMap::viridis : map_;
  tone.scale = is_depth ? ToneScale::linear : ToneScale::gamma;
  view.set_value_format(is_depth ? Dimension::length : Dimension::radiance);
  view.set_tone(tone);
  view.set_image(std::make_shared<const ImagePyramid>(std::move(image), Execution{1, {}, {}, {}}));
}

void LightFieldPanel::set_map(ColourMap map) {
  map_ = map;
  for (ImageView* view : {view_, refocused_, slice_, total_}) {
    if (view == total_ && total_kind_->currentIndex() == 1) continue;  // a picture of depths
    ToneSettings tone = view->tone_settings();
    tone.map = map;
    view->set_tone(tone);
  }
}

/// The types of the camera's microlenses, where there are several.
void LightFieldPanel::show_types() {
  QStringList names{tr("All microlenses")};
  if (jobs_.micro_images())
    for (const auto& type : jobs_.micro_images()->camera().spec().array.types)
      names << tr("Type %1 alone").arg(QString::fromStdString(type.name));
  QStringList known;
  for (int i = 0; i < type_->count(); ++i) known << type_->itemText(i);
  if (names != known) {
    type_->clear();
    type_->addItems(names);
  }
  type_->setCurrentIndex(jobs_.view_type() + 1);
  type_->setVisible(names.size() > 2);
}

void LightFieldPanel::on_views_changed() {
  const auto& views = jobs_.views();
  if (!views || views->views.empty()) {
    const QString text = document_.is_empty() ? QString()
                         : document_.camera().array.present
                             ? tr("Views are being made from the image...")
                             : tr("This camera has no microlens array, so there are no views.");
    for (QLabel* label : {view_label_, refocus_label_, slice_label_, total_label_})
      label->setText(text);
    for (ImageView* view : {view_, refocused_, slice_, total_}) view->set_image(nullptr);
    return;
  }
  show_types();
  const View& middle = views->views[views->views.size() / 2];
  // Between the nearest and the farthest that make sense for this camera, around its focus.
  if (jobs_.geometry() && jobs_.micro_images()) {
    const Camera& camera = jobs_.micro_images()->camera();
    const double focus = jobs_.geometry()->focus;
    const double least = -1.15 * camera.lens_first_order().front_focal_distance;
    const double middle_depth = std::isfinite(focus) && focus > 0 ? focus : 4 * least;
    const double nearest = std::max(least, 0.55 * middle_depth), farthest = 2.2 * middle_depth;
    const std::array<double, 2> range{nearest, farthest};
    if (range != range_) {
      // A place that was requested before there were any views applies to the first ones.
      const bool first = range_[0] == 0 && depth_wanted_ > 0;
      const bool kept = first || (depth_wanted_ >= nearest && depth_wanted_ <= farthest);
      range_ = range;
      nearest_ = nearest;
      farthest_ = farthest;
      place_depth(kept ? depth_wanted_ : middle_depth);
    }
  }
  white_ = automatic_saturation(middle.image);
  if (!jobs_.stack()) {
    total_->set_image(nullptr);
    total_label_->setText(tr("A stack of depths takes some seconds."));
  }
  if (!jobs_.refocused().image) refocused_->set_image(nullptr);
  const bool vertical = slice_direction_->currentIndex() == 1;
  const int lines = vertical ? middle.image.width : middle.image.height;
  const bool first = line_->maximum() != lines - 1;
  {
    const QSignalBlocker quiet(line_);
    line_->setRange(0, lines - 1);
    if (first) line_->setValue(lines / 2);
  }
  show_view();
  show_slice();
  if (tab() == Tab::refocus) request_refocus();
}

void LightFieldPanel::show_view() {
  const auto& views = jobs_.views();
  if (!views || views->views.empty()) return;
  const auto index = static_cast<std::size_t>(pad_->row() * LightFieldJobs::kGrid + pad_->column());
  const View& view = views->views[index];
  view_label_->setText(tr("%1 x %2 pixels, from %3, %4 raw pixels beside the middle")
                           .arg(view.image.width)
                           .arg(view.image.height)
                           .arg(view.offset.x, 0, 'f', 1)
                           .arg(view.offset.y, 0, 'f', 1));
  show(*view_, std::shared_ptr<const Image>(views, &view.image), white_);
}

void LightFieldPanel::show_refocused() {
  const DerivedImage& derived = jobs_.refocused();
  if (!derived.image) return;
  refocus_label_->setText(derived.preview
                              ? tr("%1, quick picture...").arg(length_text(derived.depth))
                              : tr("%1, %2 x %3 pixels")
                                    .arg(length_text(derived.depth))
                                    .arg(derived.image->width)
                                    .arg(derived.image->height));
  show(*refocused_, derived.image, white_);
}

void LightFieldPanel::show_stack() {
  const auto& stack = jobs_.stack();
  if (!stack) return;
  const bool depth = total_kind_->currentIndex() == 1;
  total_label_->setText(
      tr("%1 depths, %2 to %3")
          .arg(stack->planes.size())
          .arg(length_text(stack->planes.front().depth), length_text(stack->planes.back().depth)));
  show(*total_, std::shared_ptr<const Image>(stack, depth ? &stack->depth : &stack->all_in_focus),
       depth ? stack->planes.back().depth : white_, depth);
}

void LightFieldPanel::show_slice() {
  const auto& views = jobs_.views();
  if (!views || views->views.empty()) return;
  const bool vertical = slice_direction_->currentIndex() == 1;
  try {
    const Image slice = epipolar_slice(*views, line_->value(), vertical);
    // Each view's line several pixels high, so that slopes are seen.
    constexpr int kThick = 12;
    auto tall = std::make_shared<Image>(slice.width, slice.height * kThick);
    for (int row = 0; row < tall->height; ++row)
      for (int column = 0; column < tall->width; ++column)
        tall->at(column, row) = slice.at(column, row / kThick);
    slice_label_->setText(
        tr("%1 %2; one band per view. Slope is disparity: upright lines lie in the focal plane")
            .arg(vertical ? tr("Column") : tr("Row"))
            .arg(line_->value()));
    show(*slice_, tall, white_);
  } catch (const Error& error) {
    slice_label_->setText(QString::fromUtf8(error.what()));
  }
}

std::shared_ptr<const Image> LightFieldPanel::shown_image() const {
  const ImageView* const view = tab() == Tab::views     ? view_
                                : tab() == Tab::refocus ? refocused_
                                : tab() == Tab::total   ? total_
                                                        : slice_;
  if (!view->image() || view->image()->empty()) return nullptr;
  return std::shared_ptr<const Image>(view->image(), &view->image()->level(0));
}

QString LightFieldPanel::shown_name() const {
  switch (tab()) {
    case Tab::views:
      return QString("view-%1-%2").arg(pad_->row()).arg(pad_->column());
    case Tab::refocus:
      return QString("refocused-%1m").arg(depth(), 0, 'f', 3);
    case Tab::total:
      return total_kind_->currentIndex() == 1 ? "depth" : "all-in-focus";
    default:
      return "epipolar";
  }
}

}  // namespace plenoflame::desktop

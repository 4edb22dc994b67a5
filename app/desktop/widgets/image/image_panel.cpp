#include "widgets/image/image_panel.h"

#include <QAbstractItemView>
#include <QAction>
#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/develop.h"
#include "widgets/controls/glyphs.h"
#include "widgets/controls/plot_widget.h"
#include "widgets/controls/tool_row.h"
#include "widgets/image/colour_bar.h"
#include "widgets/image/image_view.h"
#include "widgets/scene/scene_geometry.h"

namespace plenoflame::desktop {
namespace {

constexpr int kLettersOfChoice = 7;
constexpr int kInferno = 3;         ///< in the list of colours
constexpr int kCountedSide = 1500;  ///< of the picture whose values the histogram counts, at most

/// Standard error over flux; 0 where there is no light.
Image relative_error(const Image& flux, const Image& error) {
  Image out(flux.width, flux.height);
  for (std::size_t i = 0; i < out.pixels.size(); ++i)
    out.pixels[i] = flux.pixels[i] > 0 ? error.pixels[i] / flux.pixels[i] : 0.0F;
  return out;
}

}  // namespace

ImagePanel::ImagePanel(Document& document, MeasuredPicture& measured, QWidget* parent)
    : QWidget(parent),
      document_(document),
      view_(new ImageView(this)),
      histogram_plot_(new PlotWidget),
      profile_plot_(new PlotWidget),
      measured_(measured) {
  view_->setObjectName("rawImage");
  view_->setToolTip(
      tr("Drag to move, wheel to zoom. Click a pixel: its rays. Shift+click: "
         "its microlens. "
         "Ctrl+drag: line profile. Arrow keys move the selected pixel."));
  auto* tools = new ToolRow("moreOfImage", tr("Size, brightness by value, value of white"), this);
  const auto combo = [&](const char* name, const QStringList& entries, const QString& tip) {
    auto* box = new QComboBox(tools);
    box->setObjectName(name);
    box->addItems(entries);
    box->setToolTip(tip);
    // The lists have room for what the toolbar, which is to stay on one line, has none for.
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(kLettersOfChoice);
    box->view()->setMinimumWidth(box->view()->sizeHintForColumn(0) + 24);
    return box;
  };
  make_choice_of_picture(*tools);
  quantity_ = combo("quantity", {tr("Flux"), tr("Standard error"), tr("Relative error")},
                    tr("What is shown: radiant flux of each pixel [W], its "
                       "standard error [W], or their ratio"));
  channel_ = combo("channel", {tr("total")}, tr("Channel (wavelengths) that is shown"));
  channel_->setSizeAdjustPolicy(QComboBox::AdjustToContents);  // names come with the image
  scale_ = combo("scale", {tr("Gamma"), tr("Linear"), tr("Logarithmic")},
                 tr("Brightness by value: as displays do, in proportion, or by "
                    "its logarithm (3 decades)"));
  map_ = combo("map", {tr("Grey"), tr("Viridis"), tr("Cividis"), tr("Inferno")},
               tr("Colours; all are even in lightness and safe for "
                  "colour-blind people"));
  map_->setCurrentIndex(kInferno);  // as for views and flame
  for (QComboBox* const box : {quantity_, channel_, map_}) tools->add(box);
  white_ = new QLineEdit(tools);
  white_->setObjectName("white");
  white_->setPlaceholderText(tr("white: auto"));
  white_->setFixedWidth(white_->fontMetrics().horizontalAdvance("white: auto") + 24);
  white_->setToolTip(
      tr("Value that is shown as white, with its unit (e.g. 500 "
         "nW); empty: 99.9 % of the lit pixels "
         "are darker"));
  const auto tool = [&](const QString& text) {
    auto* action = new QAction(text, this);
    tools->add_spare(button_for(action, tools));
    return action;
  };
  const auto marks = [&](Glyph glyph, const QString& text) {
    auto* action = new QAction(glyph_icon(glyph), text, this);
    tools->add(button_for(action, tools, true));
    return action;
  };
  saturation_ = marks(Glyph::saturated, tr("Saturation"));
  saturation_->setObjectName("saturation");
  saturation_->setCheckable(true);
  saturation_->setToolTip(
      tr("Mark pixels that the sensor of this scene "
         "saturates (develop.saturation)"));
  outlines_ = marks(Glyph::lenses, tr("Outlines"));
  outlines_->setObjectName("outlines");
  outlines_->setCheckable(true);
  outlines_->setShortcut(Qt::Key_O);
  outlines_->setToolTip(
      tr("Outlines of the micro-images, coloured by the type "
         "of their lens; zoom in to see them (O)"));
  QAction* const fit = tool(tr("Fit"));
  fit->setToolTip(tr("The whole image (F)"));
  QAction* const one = tool(tr("1:1"));
  one->setToolTip(tr("One pixel of the screen per pixel of the image (1)"));
  tools->add_spare(scale_);
  tools->add_spare(white_);
  connect(fit, &QAction::triggered, view_, &ImageView::fit);
  connect(one, &QAction::triggered, this, [this] { view_->set_scale(1); });
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(tools);
  layout->addWidget(registration_);
  auto* bar = new ColourBar(this);
  bar->setObjectName("imageBar");
  auto* row = new QHBoxLayout;
  row->setSpacing(0);
  row->addWidget(view_, 1);
  row->addWidget(bar);
  layout->addLayout(row, 1);

  histogram_plot_->setObjectName("histogram");
  histogram_plot_->set_empty_text(tr("The histogram appears with the first picture."));
  profile_plot_->setObjectName("profile");
  profile_plot_->set_empty_text(tr("Ctrl+drag across the image to see the values along a line."));

  const auto changed = QOverload<int>::of(&QComboBox::currentIndexChanged);
  connect(quantity_, changed, this, &ImagePanel::request);
  connect(channel_, changed, this, &ImagePanel::request);
  connect(channel_, changed, this, &ImagePanel::request_measured);
  connect(scale_, changed, this, &ImagePanel::apply_tone);
  connect(map_, changed, this, [this] {
    apply_tone();
    emit map_changed(map());
  });
  connect(white_, &QLineEdit::editingFinished, this, &ImagePanel::apply_tone);
  connect(saturation_, &QAction::toggled, this, &ImagePanel::apply_tone);
  connect(view_, &ImageView::profile_drawn, this, [this](const QLineF& line) {
    profile_ = line;
    update_profile();
  });
  connect(&document_, &Document::image_changed, this, &ImagePanel::request);
  connect(&document_, &Document::scene_changed, this, [this](const SceneChanges& changes) {
    if (changes.develop) apply_tone();
  });
}

void ImagePanel::request() {
  const auto field = document_.image();
  const unsigned number = ++newest_;
  if (!field || field->channels.empty()) {
    task_.cancel();
    shown_ = number;
    if (fits_camera()) {  // something is seen until there is a picture of the present scene
      left_over_ = true;
      return;
    }
    return drop_picture();
  }
  QStringList names;
  for (const LightFieldChannel& channel : field->channels)
    names << QString::fromStdString(channel.name);
  const ColourChannels colours = colours_of(*field);
  if (colours.present()) names << tr("Colour");
  QStringList known;
  for (int i = 0; i < channel_->count(); ++i) known << channel_->itemText(i);
  if (names != known) {
    const QSignalBlocker quiet(channel_);
    channel_->clear();
    channel_->addItems(names);
    // The list has room for a name where the toolbar has none.
    channel_->view()->setMinimumWidth(channel_->view()->sizeHintForColumn(0) + 24);
  }
  channel_->setToolTip(tr("Channel (wavelengths) that is shown: %1").arg(channel_->currentText()));
  const auto quantity = static_cast<Quantity>(quantity_->currentIndex());
  const std::size_t channel = channel_of(*field);
  const bool coloured = quantity == Quantity::flux &&
                        channel_->currentIndex() == static_cast<int>(field->channels.size());
  task_.request([=, this](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    const LightFieldChannel& c = field->channels[std::min(channel, field->channels.size() - 1)];
    try {
      // The image itself is the first level: it is not copied.
      const auto shared = std::shared_ptr<const Image>(field, &c.flux);
      auto flux = std::make_shared<const ImagePyramid>(shared, execution);
      std::shared_ptr<const ImagePyramid> shown = flux;
      if (quantity != Quantity::flux && !c.standard_error.empty()) {
        const auto image =
            quantity == Quantity::standard_error
                ? std::shared_ptr<const Image>(field, &c.standard_error)
                : std::make_shared<const Image>(relative_error(c.flux, c.standard_error));
        shown = std::make_shared<const ImagePyramid>(image, execution);
      }
      std::shared_ptr<ImageView::Colours> seen;
      if (coloured) {
        const auto linear = std::make_shared<const LightField>(colour_field(*field, colours));
        seen = std::make_shared<ImageView::Colours>();
        for (std::size_t k = 0; k < 3; ++k)
          (*seen)[k] = std::make_shared<const ImagePyramid>(
              std::shared_ptr<const Image>(linear, &linear->channels[k].flux), execution);
      }
      const double saturation = automatic_saturation(c.flux);
      // A relative error of 1 is as bad as it gets.
      const double white = quantity == Quantity::flux ? saturation
                           : quantity == Quantity::relative_error
                               ? 1.0
                               : automatic_saturation(shown->level(0));
      // Counted of a level that takes little time; means of pixels when the image is
      // large.
      const Histogram counts =
          histogram(shown->level(shown->level_within(kCountedSide)), 80, true, 4);
      post(this, [=, this, on_sensor = picture_on_sensor(*flux)] {
        if (number != newest_) return;
        shown_ = number;
        left_over_ = false;
        flux_pyramid_ = flux;
        on_sensor_ = on_sensor;
        pyramid_ = shown;
        colours_ = seen;
        automatic_white_ = white > 0 ? white : 1;
        automatic_saturation_ = saturation;
        show_picture();
        show_histogram(counts);
        emit pyramid_changed();
      });
    } catch (const std::exception&) {  // stopped, or an image that is replaced soon
    }
  });
}

/// True if what is shown has the pixels of the document's camera.
bool ImagePanel::fits_camera() const {
  if (!pyramid_ || document_.is_empty()) return false;
  const SensorSpec& sensor = document_.camera().sensor;
  return pyramid_->width() == sensor.columns && pyramid_->height() == sensor.rows;
}

void ImagePanel::drop_left_over() {
  if (left_over_) drop_picture();
}

void ImagePanel::drop_picture() {
  left_over_ = false;
  pyramid_ = flux_pyramid_ = nullptr;
  on_sensor_ = nullptr;
  colours_ = nullptr;
  show_picture();
  histogram_plot_->set_series({});
  emit pyramid_changed();
}

QImage ImagePanel::poster(const QSize& size, const QColor& background, double& metres) const {
  ImageView whole;
  QPalette ground = whole.palette();
  ground.setColor(QPalette::Dark, background);
  whole.setPalette(ground);
  whole.set_smooth(true);
  whole.set_tone(view_->tone_settings());
  const double ratio = whole.devicePixelRatioF();
  whole.resize((QSizeF(size) / ratio).toSize());
  whole.set_image(view_->image());
  whole.set_colours(picture() == Picture::simulated ? colours_ : nullptr);
  whole.set_overlay(view_->overlay(), measured_white());
  const bool there = view_->image() && !view_->image()->empty();
  metres = there ? document_.camera().sensor.pixel().x / whole.scale() : 0;
  QImage drawn = whole.grab().toImage().scaled(size);
  drawn.setDevicePixelRatio(1);
  return drawn;
}

std::size_t ImagePanel::channel_of(const LightField& field) const {
  const auto chosen = static_cast<std::size_t>(std::max(0, channel_->currentIndex()));
  const ColourChannels colours = colours_of(field);
  if (chosen < field.channels.size() || !colours.present()) return chosen;
  std::size_t index = 0;
  while (field.channels[index].name != colours.names[1]) ++index;
  return index;
}

/// The channels of a field that are a colour picture, by the scene that it is of.
ColourChannels ImagePanel::colours_of(const LightField& field) const {
  if (document_.is_empty()) return {};
  const ColourChannels colours = colour_channels(document_.scene());
  const auto has = [&](const std::string& name) {
    return std::any_of(field.channels.begin(), field.channels.end(),
                       [&](const LightFieldChannel& channel) { return channel.name == name; });
  };
  return std::all_of(colours.names.begin(), colours.names.end(), has) ? colours : ColourChannels();
}

ColourMap ImagePanel::map() const {
  constexpr std::array<ColourMap, 4> kMaps{ColourMap::grey, ColourMap::viridis, ColourMap::cividis,
                                           ColourMap::inferno};
  return kMaps[static_cast<std::size_t>(std::clamp(map_->currentIndex(), 0, kInferno))];
}

void ImagePanel::apply_tone() {
  ToneSettings tone;
  tone.scale = scale_->currentIndex() == 1   ? ToneScale::linear
               : scale_->currentIndex() == 2 ? ToneScale::logarithmic
                                             : ToneScale::gamma;
  tone.map = map();
  const Dimension unit = dimension();
  tone.white = picture() == Picture::measured ? measured_white() : automatic_white_;
  white_->setStyleSheet({});
  if (!white_->text().trimmed().isEmpty()) {
    try {
      const double value = parse_quantity(white_->text().trimmed().toStdString(), unit);
      if (!(value > 0)) throw InputError("white must be above 0");
      tone.white = value;
      white_->setToolTip(tr("Value that is shown as white, with its unit; empty: automatic"));
    } catch (const Error& error) {
      white_->setStyleSheet("QLineEdit { background: #b3261e; color: white; }");
      white_->setToolTip(QString::fromUtf8(error.what()));
    }
  }
  if (saturation_->isChecked() && !document_.is_empty() &&
      static_cast<Quantity>(quantity_->currentIndex()) == Quantity::flux) {
    const double given = document_.scene().develop.saturation;
    tone.saturation = given > 0 ? given : automatic_saturation_;
  }
  view_->set_tone(tone);
  view_->set_value_format(unit);
  auto* const bar = findChild<ColourBar*>("imageBar");
  const LightField* const field = drawn_field();
  const bool bare = unit == Dimension::none && !shows_relative_error() && field;
  bar->set_tone(tone, unit, bare ? QString::fromStdString(field->unit) : QString());
  // A picture in its own colours has no bar of them.
  bar->setVisible(picture() != Picture::overlay && !(colours_ && picture() == Picture::simulated));
}

void ImagePanel::update_profile() {
  view_->set_profile_line(profile_);
  // The line shows the picture that is seen; where two lie over each other, the simulated one.
  const auto& seen = picture() == Picture::measured  ? measured_pyramid_
                     : picture() == Picture::overlay ? flux_pyramid_
                                                     : pyramid_;
  if (!seen || seen->empty() || profile_.length() <= 0) return;
  PlotWidget::Series series;
  series.colour = QColor(0, 114, 178);
  const auto values =
      line_profile(seen->level(0), profile_.x1(), profile_.y1(), profile_.x2(), profile_.y2());
  const double step =
      profile_.length() / static_cast<double>(std::max<std::size_t>(1, values.size() - 1));
  for (std::size_t i = 0; i < values.size(); ++i)
    series.points << QPointF(static_cast<double>(i) * step, values[i]);
  profile_plot_->set_axes(tr("along the line [pixel]"),
                          value_title(drawn_field(), shows_relative_error()), false, false);
  profile_plot_->set_series({series});
}

void ImagePanel::show_histogram(const Histogram& counts) {
  PlotWidget::Series series;
  series.colour = QColor(0, 114, 178);
  const double decades = std::log10(counts.upper / counts.lower);
  series.bar_width = decades / static_cast<double>(counts.counts.size());
  if (counts.upper > 0)
    for (std::size_t i = 0; i < counts.counts.size(); ++i)
      if (counts.counts[i] > 0)
        series.points << QPointF(
            counts.lower * std::pow(10.0, decades * (static_cast<double>(i) + 0.5) /
                                              static_cast<double>(counts.counts.size())),
            counts.counts[i]);
  histogram_plot_->set_axes(
      value_title(document_.image().get(),
                  static_cast<Quantity>(quantity_->currentIndex()) == Quantity::relative_error),
      tr("pixels"), true, true);
  histogram_plot_->set_series({series});
}

QString ImagePanel::value_title(const LightField* field, bool relative_error) const {
  if (relative_error) return tr("relative error");
  return tr("flux [%1]").arg(field ? QString::fromStdString(field->unit) : QString("W"));
}

QString ImagePanel::describe(int column, int row) const {
  const QString flux = flux_text(column, row);
  if (flux.isEmpty()) return {};
  const QString text = tr("pixel %1, %2   flux %3").arg(column).arg(row).arg(flux);
  const auto& measured = measured_.field();
  if (!measured || measured == document_.image()) return text;
  const QString its = value_text(*measured, column, row);
  return its.isEmpty() ? text : tr("%1   measured %2").arg(text, its);
}

QString ImagePanel::flux_text(int column, int row) const {
  return document_.image() ? value_text(*document_.image(), column, row) : QString();
}

QString ImagePanel::value_text(const LightField& field, int column, int row) const {
  const std::size_t index = channel_of(field);
  if (column < 0 || index >= field.channels.size()) return {};
  const LightFieldChannel& channel = field.channels[index];
  const int x = column - field.window.x, y = row - field.window.y;
  if (x < 0 || y < 0 || x >= channel.flux.width || y >= channel.flux.height) return {};
  const auto readable = [&](float value, int digits) {
    return QString::fromStdString(
        readable_quantity(static_cast<double>(value), dimension_of(field), digits));
  };
  QString text = readable(channel.flux.at(x, y), 4);
  if (!channel.standard_error.empty())
    text += tr(" \302\261 %1").arg(readable(channel.standard_error.at(x, y), 2));
  if (dimension_of(field) == Dimension::none) text += " " + QString::fromStdString(field.unit);
  return text;
}

}  // namespace plenoflame::desktop

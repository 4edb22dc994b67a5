// The image view, the light-field panel and the drawing of the flame. References: sums
// over the document's image.
#include <QAction>
#include <QComboBox>
#include <QFile>
#include <QLabel>
#include <QLineEdit>
#include <QSlider>
#include <QTabWidget>
#include <algorithm>
#include <cmath>
#include <vector>

#include "gui_tests.h"
#include "plenoflame/base/units.h"
#include "plenoflame/volumes/grid_writer.h"
#include "widgets/controls/plot_widget.h"
#include "widgets/flame/flame_panel.h"
#include "widgets/flame/opacity_curve.h"
#include "widgets/image/colour_bar.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/scene/section_view.h"
#include "window_fixture.h"

using namespace plenoflame;
using namespace plenoflame::desktop;
using plenoflame::desktop::test::difference;

class PictureTest : public test::WindowFixture {
  Q_OBJECT

  void open_small() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
  }
  const LightFieldChannel& channel() { return session().document().image()->channels[0]; }
  void choose(const char* box, const QString& text) {
    auto* combo = child<QComboBox>(box);
    combo->setFocus();
    for (int i = 0; i < combo->count() && combo->currentText() != text; ++i)
      QTest::keyClick(combo, i == 0 ? Qt::Key_Home : Qt::Key_Down);
    QCOMPARE(combo->currentText(), text);
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void barBesideTheImageHasItsValues() {
    open_small();
    auto* bar = child<ColourBar>("imageBar");
    QVERIFY(bar->isVisible());
    QCOMPARE(bar->labels().front().section(' ', 0, 0), QString("0"));
    auto* white = child<QLineEdit>("white");
    white->setFocus();
    QTest::keyClicks(white, "20 nW");
    QTest::keyClick(white, Qt::Key_Return);
    QCOMPARE(bar->labels().back(), QString("20 nW"));
    QVERIFY(bar->labels()[2].endsWith("W"));
  }

  void profileHasTheValuesAlongTheLine() {
    open_small();
    image().set_scale(4);
    image().centre_on(150, 150);
    QTest::qWait(30);
    const QPoint a = of_pixel(120, 150), b = of_pixel(180, 150);
    drag(&image(), a, b, Qt::ControlModifier);
    auto* plot = dynamic_cast<PlotWidget*>(child<QWidget>("profile"));
    QVERIFY(plot && plot->series().size() == 1);
    const auto& points = plot->series()[0].points;
    QVERIFY(points.size() >= 60);
    // The light along the line is that of the pixels it crosses.
    double drawn = 0, there = 0;
    for (const QPointF& p : points) drawn += p.y();
    for (int column = 120; column <= 180; ++column)
      there += static_cast<double>(channel().flux.at(column, 150));
    QVERIFY(std::fabs(drawn / points.size() / (there / 61) - 1) < 0.05);
    QVERIFY(std::fabs(points.back().x() - 60) < 1);
    QVERIFY(plot->isVisible());
  }

  void barsStandOnNothingAndAreAsWideAsTheySay() {
    PlotWidget plot;
    plot.resize(500, 300);
    plot.set_axes("x", "y", false, false);
    PlotWidget::Series series;
    series.colour = QColor(255, 0, 0);
    series.bar_width = 2;
    series.points = {{10, 5}, {30, 10}};  // nothing between them
    plot.set_series({series});
    const QImage picture = plot.grab().toImage();
    std::vector<int> heights;  // of columns
    for (int x = 0; x < picture.width(); ++x) {
      int height = 0;
      for (int y = 0; y < picture.height(); ++y) {
        const QColor colour(picture.pixel(x, y));
        height += colour.red() > 200 && colour.green() < 90;
      }
      heights.push_back(height);
    }
    const int high = *std::max_element(heights.begin(), heights.end());
    QVERIFY(high > 150);
    const auto columns = [&](int low, int up) {
      return std::count_if(heights.begin(), heights.end(),
                           [&](int h) { return h >= low && h <= up; });
    };
    // Half as high, and both a tenth of the 20 from one to the other.
    const auto first = columns(high / 2 - 2, high / 2 + 2), second = columns(high - 1, high);
    const auto from = std::find_if(heights.begin(), heights.end(), [](int h) { return h > 9; });
    const auto to =
        std::find_if(heights.begin(), heights.end(), [&](int h) { return h > high - 2; });
    const double step = static_cast<double>(to - from);
    QVERIFY(std::fabs(static_cast<double>(first) - 0.1 * step) <= 2);
    QVERIFY(std::fabs(static_cast<double>(second) - 0.1 * step) <= 2);
    QVERIFY(std::fabs(static_cast<double>(columns(10, high)) - 0.2 * step) <= 4);
  }

  void histogramCountsEveryLitPixel() {
    open_small();
    auto* plot = dynamic_cast<PlotWidget*>(child<QWidget>("histogram"));
    QVERIFY(plot && plot->series().size() == 1);
    double counted = 0;
    for (const QPointF& p : plot->series()[0].points) counted += p.y();
    // Four decades below the largest; what is darker is not in it.
    double largest = 0, lit = 0;
    for (const float f : channel().flux.pixels) largest = std::max(largest, static_cast<double>(f));
    for (const float f : channel().flux.pixels)
      lit += static_cast<double>(f) >= 1e-4 * largest ? 1 : 0;
    QVERIFY(lit > 1000);
    QVERIFY2(std::fabs(counted / lit - 1) < 0.01,
             qPrintable(QString("%1 of %2").arg(counted).arg(lit)));
    raise("histogramGroup");
    const QImage before = plot->grab().toImage();
    choose("quantity", "Standard error");
    QVERIFY(until([&] { return difference(before, plot->grab().toImage()) > 1e-3; }));
  }

  void saturatedPixelsAreMarked() {
    open_small();
    double largest = 0;
    for (const float f : channel().flux.pixels) largest = std::max(largest, static_cast<double>(f));
    const double threshold = 0.5 * largest;
    session().document().set_value("develop.saturation",
                                   readable_quantity(threshold, Dimension::flux, 17));
    QVERIFY(settled());
    int above = 0;
    for (const float f : channel().flux.pixels)
      above += static_cast<double>(f) >= threshold ? 1 : 0;
    QVERIFY(above > 10);
    QTest::keyClick(&image(), Qt::Key_1);
    const QImage plain = image().grab().toImage();
    child<QAction>("saturation")->trigger();
    QVERIFY(image().tone_settings().saturation > 0);
    // At one to one every pixel of the image is one of the screen.
    const QImage marked = image().grab().toImage();
    int changed = 0;
    for (int y = 1; y + 1 < plain.height(); ++y)
      for (int x = 1; x + 1 < plain.width(); ++x)
        changed += plain.pixel(x, y) != marked.pixel(x, y) ? 1 : 0;
    QVERIFY2(std::abs(changed - above) <= 0.02 * above + 2,
             qPrintable(QString("%1 marked of %2").arg(changed).arg(above)));
  }

  void errorMapsAndScalesAreShown() {
    open_small();
    QList<QImage> seen{image().grab().toImage()};
    for (const char* text : {"Standard error", "Relative error"}) {
      choose("quantity", text);
      QVERIFY(until([&] { return difference(seen.back(), image().grab().toImage()) > 0.05; }));
      seen << image().grab().toImage();
    }
    // In the map of relative errors the value shown is the ratio.
    QVERIFY(window_->image_panel().pyramid());
    const float shown = window_->image_panel().pyramid()->level(0).at(150, 140);
    QVERIFY(
        std::fabs(static_cast<double>(shown) * static_cast<double>(channel().flux.at(150, 140)) /
                      static_cast<double>(channel().standard_error.at(150, 140)) -
                  1) < 1e-5);
    choose("quantity", "Flux");
    QVERIFY(until([&] { return difference(seen.front(), image().grab().toImage()) == 0; }));
    for (const char* text : {"Linear", "Logarithmic"}) {
      const QImage before = image().grab().toImage();
      choose("scale", text);
      QVERIFY(difference(before, image().grab().toImage()) > 0.02);
    }
    // White that is half as bright, by a number with its unit.
    const QImage before = image().grab().toImage();
    auto* white = child<QLineEdit>("white");
    QTest::keyClicks(white, QString::fromStdString(readable_quantity(
                                0.3 * image().tone_settings().white, Dimension::flux, 4)));
    QTest::keyClick(white, Qt::Key_Return);
    QVERIFY(difference(before, image().grab().toImage()) > 0.02);
    white->selectAll();
    QTest::keyClicks(white, "3 kg");
    QTest::keyClick(white, Qt::Key_Return);
    QVERIFY(white->toolTip().contains("kg"));
  }

  void pointerIsDescribedInTheStatusBar() {
    open_small();
    image().set_scale(8);
    image().centre_on(150, 150);
    QTest::mouseMove(&image(), of_pixel(145, 150));
    auto* label = child<QLabel>("pointerLabel");
    QVERIFY(until([&] { return label->text().contains("145, 150"); }));
    QVERIFY(label->text().contains(QString::fromStdString(
        readable_quantity(static_cast<double>(channel().flux.at(145, 150)), Dimension::flux))));
  }

  void apertureDepthAndLineAreDraggedByThePointer() {
    QVERIFY(window_->open_example("paper-previous-60x60"));
    show_tab(LightFieldPanel::Tab::views);
    QVERIFY(settled());
    QVERIFY(until([&] { return session().light_field().views() != nullptr; }));
    auto* pad = child<QWidget>("aperturePad");
    auto* view = child<ImageView>("subApertureView");
    const QPoint middle = pad->rect().center();
    const double step = 0.7 * (std::min(pad->width(), pad->height()) - 8.0) / LightFieldJobs::kGrid;
    const QImage from_the_middle = view->grab().toImage();
    drag(pad, middle, middle + QPointF(3 * step, 0));
    // Three views to the right of the middle one.
    QCOMPARE(window_->light_field_panel().shown_name(), QString("view-4-7"));
    QVERIFY(difference(from_the_middle, view->grab().toImage()) > 1e-3);
    show_tab(LightFieldPanel::Tab::refocus);
    auto* slider = child<QSlider>("depthSlider");
    const double before = window_->light_field_panel().depth();
    // The handle, ten pixels wide, is taken where it stands.
    const double place = static_cast<double>(slider->value()) / slider->maximum(),
                 handle = 6 + place * (slider->width() - 12.0), y = 0.5 * slider->height();
    drag(slider, QPointF(handle, y), QPointF(handle - 0.25 * slider->width(), y));
    QVERIFY(window_->light_field_panel().depth() < 0.95 * before);
    const double wanted = window_->light_field_panel().depth();
    const auto exact = [&] {
      const DerivedImage& r = session().light_field().refocused();
      return r.image && !r.preview && std::fabs(r.depth / wanted - 1) < 1e-9;
    };
    QVERIFY(until(exact));
    show_tab(LightFieldPanel::Tab::slice);
    auto* slice = child<ImageView>("epipolarView");
    QVERIFY(slice->image() != nullptr);
    const QImage earlier = slice->grab().toImage();
    QTest::keyClick(child<QSlider>("lineSlider"), Qt::Key_PageUp);
    QVERIFY(difference(earlier, slice->grab().toImage()) > 1e-3);
    QVERIFY(child<ImageView>("epipolarView")->image()->height() % LightFieldJobs::kGrid == 0);
  }

  void lookOfTheFlameIsWhatIsDrawn() {
    open_small();
    press(Qt::Key_2, Qt::ControlModifier);  // the flame fills the view
    QVERIFY(settled());
    Document& document = session().document();
    const auto [coldest, hottest] = window_->scene_view().flame_temperatures();
    QVERIFY(coldest > 0 && hottest > coldest);
    struct Drawn {
      double covered = 0;  // differs from the background, summed
      int green = 0;       // pixels that differ clearly with more green than red
      int width = 0;       // columns in which pixels differ clearly
    };
    const auto draw = [&](const FlameLook& look) {
      document.set_look(look, "test");
      const QImage picture = window_->scene_view().picture();
      const QColor back(picture.pixel(2, picture.height() / 2));
      Drawn out;
      for (int x = 0; x < picture.width(); ++x) {
        bool any = false;
        for (int y = 0; y < picture.height() * 3 / 4; ++y) {  // below is the bar of temperatures
          const QColor c(picture.pixel(x, y));
          const int differs = std::abs(c.red() - back.red()) + std::abs(c.green() - back.green()) +
                              std::abs(c.blue() - back.blue());
          out.covered += differs;
          if (differs < 40) continue;
          any = true;
          out.green += c.green() > c.red() + 15 ? 1 : 0;
        }
        out.width += any ? 1 : 0;
      }
      return out;
    };
    FlameLook plain;
    plain.drawing = FlameDrawing::emission;
    FlameLook look = plain;
    const Drawn usual = draw(look);
    QVERIFY(usual.covered > 0);
    look.density = 4;
    const Drawn dense = draw(look);
    look.density = 0.25;
    const Drawn thin = draw(look);
    QVERIFY(dense.covered > 1.1 * usual.covered && usual.covered > 1.1 * thin.covered);
    look = plain;
    look.map = ColourMap::viridis;
    const Drawn viridis = draw(look);
    QVERIFY2(viridis.green > 500 && usual.green < viridis.green / 10,
             qPrintable(QString("%1, %2").arg(viridis.green).arg(usual.green)));
    // A range below all temperatures: everything is as hot as can be, nearly white before the dark
    // background; one above: as cold, dark.
    look = plain;
    look.automatic = false;
    look.cold = 0.4 * coldest;
    look.hot = 0.8 * coldest;
    const Drawn hot = draw(look);
    look.cold = 1.2 * hottest;
    look.hot = 1.6 * hottest;
    const Drawn cold = draw(look);
    QVERIFY2(hot.covered > 1.4 * cold.covered,
             qPrintable(QString("%1, %2").arg(hot.covered).arg(cold.covered)));
    // Only what is hot, and only what is cold: how far from the axis that is, the medium says.
    const Medium& medium = *session().compiler().compiled()->medium;
    const Box box = medium.bounds();
    double hot_reach = 0, cold_reach = 0;
    for (double z = box.lower.z; z < box.upper.z; z += 1e-3)
      for (double y = 0; y < box.upper.y; y += 2.5e-4) {
        const MediumSample here = medium.sample({0.5 * (box.lower.x + box.upper.x), y, z});
        if (here.absorption <= 0) continue;
        const double place = (here.temperature - coldest) / (hottest - coldest);
        if (place > 0.9) hot_reach = std::max(hot_reach, y);
        if (place < 0.1) cold_reach = std::max(cold_reach, y);
      }
    look = plain;
    look.density = 20;
    look.points = {{0, 0}, {0.9, 0}, {1, 1}};
    const int hot_width = draw(look).width;
    look.points = {{0, 1}, {0.1, 0}, {1, 0}};
    const int cold_width = draw(look).width;
    QVERIFY2(hot_width > 10 && cold_width > 10,
             qPrintable(QString("%1, %2").arg(hot_width).arg(cold_width)));
    QVERIFY(std::fabs(hot_reach / cold_reach - 1) > 0.1);
    QVERIFY2((hot_reach > cold_reach) == (hot_width > cold_width),
             qPrintable(QString("%1, %2").arg(hot_width).arg(cold_width)));
  }

  void legendHidesNoCurve() {
    PlotWidget plot;
    plot.resize(320, 240);
    plot.set_axes("x", "y", false, false);
    // Along the lower and the left rim only, so that the rest of the area stays empty.
    const QColor ink(200, 30, 30);
    std::vector<PlotWidget::Series> series(2);
    series[0].points = {{0, 0}, {1, 0}};
    series[1].points = {{0, 0}, {0, 1}};
    for (auto& s : series) s.colour = ink;
    series[0].name = "a name that is long enough";
    series[1].name = "another one that needs a line of its own";
    plot.set_series(series);
    const QImage shown = plot.grab().toImage();
    const QRectF area = plot.area();
    QVERIFY(area.height() > 100);
    int inside = 0, above = 0;
    for (int y = 0; y < shown.height(); ++y)
      for (int x = 0; x < shown.width(); ++x) {
        const QColor c(shown.pixel(x, y));
        if (c.red() - c.green() < 60) continue;
        inside += x > area.left() + 20 && y > area.top() && y < area.bottom() - 20 ? 1 : 0;
        above += y < area.top() ? 1 : 0;
      }
    QCOMPARE(inside, 0);
    QVERIFY(above > 30);  // a line beside each name
    const QRectF with_names = area;
    for (auto& s : series) s.name.clear();
    plot.set_series(series);
    plot.grab();
    QVERIFY(plot.area().top() + 20 < with_names.top());
  }

  void namesOfChannelsAreNotCut() {
    QVERIFY(window_->open_example("lenslets-30"));
    const std::string name = "red_with_the_filter";
    session().document().set_value("channels[0].name", name);
    QVERIFY(settled());
    session().start_render();
    QVERIFY(settled());
    auto* box = child<QComboBox>("channel");
    QVERIFY(until([&] { return box->currentText() == QString::fromStdString(name); }));
    const int wanted = box->fontMetrics().horizontalAdvance(box->currentText());
    QVERIFY2(until([&] { return box->width() > wanted + 20; }),
             qPrintable(QString("%1 for %2").arg(box->width()).arg(wanted)));
  }

  void clearFlameIsDrawnByWhatItEmits() {
    // 16 mm x 16 mm x 48 mm of CH*, the same everywhere, and no absorption.
    constexpr double kVoxel = 2e-3;
    VoxelField light;
    light.name = "CH";
    light.brick_origins = {{0, 0, 0}, {0, 0, 8}, {0, 0, 16}};
    light.values.assign(light.brick_origins.size() * 512, 1000);
    light.index_to_world.linear.rows = {{{kVoxel, 0, 0}, {0, kVoxel, 0}, {0, 0, kVoxel}}};
    const GridOutput grid{&light, "W/(m^3 sr)"};
    write_grids(folder_->filePath("blue.vdb").toStdString(), {&grid, 1});
    QFile example(":/examples/lenslets-30.toml");
    QVERIFY(example.open(QIODevice::ReadOnly));
    QString text = QString::fromUtf8(example.readAll());
    text.replace("preset = \"paper-layered\"", "kind = \"vdb\"\nfile = \"blue.vdb\"");
    text.replace("\"-29 mm\"]\n", "\"-24 mm\"]\n[[flames.lines]]\nkind = \"ch\"\n");
    text.replace("\"650 nm\"", "\"431.5 nm\"");
    QFile scene(folder_->filePath("blue.toml"));
    QVERIFY(scene.open(QIODevice::WriteOnly));
    scene.write(text.toUtf8());
    scene.close();
    QVERIFY2(window_->open(scene.fileName()), qPrintable(window_->last_message()));
    QVERIFY2(settled(), qPrintable(window_->last_message()));
    press(Qt::Key_2, Qt::ControlModifier);  // the flame fills the view
    SceneView& view = window_->scene_view();
    const double half = 4 * kVoxel;
    QColor inside, outside;
    // Until it is so: the window may still be laid out anew while it is looked at.
    const bool drawn = until([&] {
      if (!window_->is_settled()) return false;
      const QImage shown = view.picture();
      const QPoint middle = view.to_widget({1 + half, half, 0}).toPoint(),
                   beside = middle - QPoint(shown.width() * 2 / 5, 0);
      if (!shown.rect().contains(middle) || !shown.rect().contains(beside)) return false;
      inside = QColor(shown.pixel(middle));
      outside = QColor(shown.pixel(beside));
      return outside == QColor(shown.pixel(2, 2)) &&
             (std::abs(inside.lightness() - outside.lightness()) > 20 ||
              std::abs(inside.blue() - outside.blue()) > 20);
    });
    QVERIFY2(drawn, qPrintable(inside.name() + " in the flame, beside it " + outside.name()));
    // In the section, too: no temperature is needed to see where it is.
    const QImage section = window_->section_view().grab().toImage();
    const QPoint axis = window_->section_view().to_widget(1 + half, 0).toPoint(),
                 beside = window_->section_view().to_widget(1 + half, 0.03).toPoint();
    QVERIFY(section.pixel(axis + QPoint(0, 3)) != section.pixel(beside));
  }

  void opacityOfTheFlameIsDrawnByHandAndUndone() {
    open_small();
    raise("flameGroup");
    QVERIFY(until([&] { return window_->flame_panel().sampler().samples() != nullptr; }));
    QVERIFY(until([&] { return window_->scene_view().flame_temperatures()[1] > 0; }));
    auto* curve = dynamic_cast<OpacityCurve*>(child<QWidget>("flameOpacity"));
    QVERIFY(curve);
    FlameLook plain;
    plain.drawing = FlameDrawing::emission;
    session().document().begin_look(plain);
    Document& document = session().document();
    const bool was_modified = document.is_modified();
    press(Qt::Key_2, Qt::ControlModifier);  // the flame fills the view
    QTest::qWait(100);
    const QImage whole = window_->scene_view().picture();
    const auto look = [&] { return document.look().points; };
    const auto at = [&](double place, double opacity) {
      return curve->to_widget({place, opacity}).toPoint();
    };
    // A click adds a point, and the drag that follows moves it: cold gas is hidden.
    drag(curve, at(0.5, 0.8), at(0.7, 0.1));
    QCOMPARE(look().size(), std::size_t(3));
    QVERIFY(std::fabs(look()[1].place - 0.7) < 0.02 && std::fabs(look()[1].opacity - 0.1) < 0.03);
    drag(curve, at(0, 1), at(0, 0));
    QVERIFY(look()[0].place == 0 && look()[0].opacity < 0.03);
    QTest::qWait(100);
    QVERIFY(difference(whole, window_->scene_view().picture()) > 1e-3);
    // Each drag is one step; the scene's file has nothing of it.
    QCOMPARE(document.is_modified(), was_modified);
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(look()[0].opacity, 1.0);
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(look().size(), std::size_t(2));
    QTest::qWait(100);
    QCOMPARE(difference(whole, window_->scene_view().picture()), 0.0);
    press(Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
    QCOMPARE(look().size(), std::size_t(3));
    // By keys: up by a tenth, then away. The next window remembers what is left.
    curve->setFocus();
    QTest::keyClick(curve, Qt::Key_N);
    while (curve->chosen() != 1) QTest::keyClick(curve, Qt::Key_N);
    const double opacity = look()[1].opacity;
    QTest::keyClick(curve, Qt::Key_Up, Qt::ShiftModifier);
    QVERIFY(std::fabs(look()[1].opacity - opacity - 0.1) < 1e-9);
    const auto kept = look();
    window_->close();
    window_.reset();
    make_window();
    QVERIFY(session().document().look().points == kept);
    QVERIFY(!session().document().can_undo());
    open_small();
    raise("flameGroup");
    curve = dynamic_cast<OpacityCurve*>(child<QWidget>("flameOpacity"));
    QTest::mouseClick(curve, Qt::RightButton, {}, curve->to_widget(kept[1]).toPoint());
    QCOMPARE(session().document().look().points.size(), std::size_t(2));
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_picture_test() {
  return std::make_unique<PictureTest>();
}

#include "picture_test.moc"

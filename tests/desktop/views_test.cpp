// The views' contents and their movement, by the pointer and by keys. References: the light
// field, the medium, places in the camera's frame as docs/reference defines it.
#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkPropCollection.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkTexture.h>

#include <QAbstractButton>
#include <QComboBox>
#include <QLabel>
#include <QSet>
#include <QSlider>
#include <QTabWidget>
#include <QTableWidget>
#include <QToolButton>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "gui_tests.h"
#include "plenoflame/base/units.h"
#include "plenoflame/lightfield/micro_images.h"
#include "scene_fixture.h"
#include "widgets/image/light_field_panel.h"

using namespace plenoflame;
using namespace plenoflame::desktop;
using plenoflame::desktop::test::difference;

class ViewsTest : public test::SceneFixture {
  Q_OBJECT

  QString pointed() { return child<QLabel>("pointerLabel")->text(); }
  const Image& flux() { return session().document().image()->channels[0].flux; }
  /// True for what is seen where nothing is drawn.
  bool is_background(QRgb colour) {
    auto* const widget = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
    std::array<double, 3> back{};
    widget->renderWindow()->GetRenderers()->GetFirstRenderer()->GetBackground(back.data());
    const std::array<int, 3> rgb{qRed(colour), qGreen(colour), qBlue(colour)};
    for (std::size_t k = 0; k < 3; ++k)
      if (std::fabs(rgb[k] - 255 * back[k]) > 1) return false;
    return true;
  }
  /// The picture on the sensor as VTK is given it, rows upwards; null: there is none.
  vtkImageData* sensor_texture() {
    auto* const widget = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
    vtkPropCollection* const props =
        widget->renderWindow()->GetRenderers()->GetFirstRenderer()->GetViewProps();
    for (int i = 0; i < props->GetNumberOfItems(); ++i) {
      auto* const actor = vtkActor::SafeDownCast(props->GetItemAsObject(i));
      if (!actor || !actor->GetVisibility() || !actor->GetTexture()) continue;
      auto* const image = vtkImageData::SafeDownCast(actor->GetTexture()->GetInput());
      if (image && image->GetDimensions()[0] == flux().width) return image;
    }
    return nullptr;
  }
  /// Tells if it shows the present image: 99.9 % of the lit pixels not white, a power of 1 / 2.2.
  bool sensor_shows_the_image() {  // and the panel's worker has made it
    vtkImageData* const texture = sensor_texture();
    if (!texture || texture != window_->image_panel().on_sensor()) return false;
    std::vector<float> lit;
    for (const float f : flux().pixels)
      if (f > 0) lit.push_back(f);
    std::sort(lit.begin(), lit.end());
    const auto white = static_cast<double>(lit[static_cast<std::size_t>(0.999 * (lit.size() - 1))]);
    for (int row = 0; row < flux().height; row += 7)
      for (int column = 0; column < flux().width; column += 7) {
        const double value =
            std::pow(std::min(1.0, static_cast<double>(flux().at(column, row)) / white), 1 / 2.2);
        const auto place = static_cast<vtkIdType>(flux().height - 1 - row) * flux().width + column;
        const double drawn = texture->GetPointData()->GetScalars()->GetComponent(place, 1);
        if (std::fabs(drawn - 255 * value) > 1) return false;
      }
    return true;
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void sceneThatIsThereBeforeItsFirstShowStays() {
    QVERIFY(open_example("lenslets-30"));
    SceneView plain, warmed;
    for (SceneView* const shown : {&plain, &warmed}) {
      shown->resize(500, 400);
      shown->show_part(SceneView::Part::camera);
      shown->set_picture(window_->image_panel().on_sensor());
      shown->set_scene(session().compiler().compiled(), SceneChanges::all());
    }
    warmed.warm_up();  // what follows is not there yet: no event was handled in between
    for (SceneView* const shown : {&plain, &warmed}) {
      shown->show();
      QVERIFY(QTest::qWaitForWindowExposed(shown));
      QVERIFY(until([&] { return shown->is_current(); }));
      shown->show_part(SceneView::Part::scene);
      shown->show_part(SceneView::Part::camera);  // aims anew, at the size that it has by now
    }
    QTest::qWait(100);
    QVERIFY(difference(plain.picture(), warmed.picture()) < 1e-3);
  }

  void keysThatVtkKnowsDoNothing() {
    QVERIFY(open_example("lenslets-30"));
    const QImage before = view().picture();
    scene3d()->setFocus();
    for (const char key : {'3', 'w', 's', 'p', 'f', 'i', 'r', 'j', 'e', 'q'})
      QTest::keyClick(scene3d(), key);
    QTest::qWait(50);
    QCOMPARE(difference(before, view().picture()), 0.0);
    QVERIFY(window_->isVisible());
    // The window's own ones arrive.
    session().document().select(Selection::of_pixel(150, 150));
    QTest::keyClick(scene3d(), Qt::Key_Escape);
    QVERIFY(session().document().selection() == Selection());
  }

  void sensorShowsTheLiveImage() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_3));
    QVERIFY(sensor_shows_the_image());
    const Image before = flux();
    session().document().set_value("flames[0].position", "1 m, 2 mm, -29 mm");
    QVERIFY(settled());
    QVERIFY(flux().pixels != before.pixels);
    QVERIFY(sensor_shows_the_image());
  }

  void sceneIsTurnedMovedAndZoomedByThePointer() {
    QVERIFY(open_example("lenslets-30"));
    const Vec3 flame = world({0, 0, 1.0}), lens = world({0, 0, 0});
    const auto places = [&] { return std::pair(view().to_widget(flame), view().to_widget(lens)); };
    const auto apart = [](QPointF a, QPointF b) {
      return std::hypot(a.x() - b.x(), a.y() - b.y());
    };
    const QPointF middle = scene3d()->rect().center();
    const double height = view().view_height();
    const auto first = places();
    drag(scene3d(), middle, middle + QPointF(120, 0));
    const auto turned = places();
    QVERIFY(std::fabs(view().view_height() / height - 1) < 1e-9);
    // From the side towards the front: the two come closer to each other.
    QVERIFY(std::fabs(apart(turned.first, turned.second) / apart(first.first, first.second) - 1) >
            0.05);
    QVERIFY(selection().kind == Selection::Kind::none);
    // The place under the pointer stays there, and the wheel leads back.
    wheel(scene3d(), turned.second, 3);
    QVERIFY(apart(places().second, turned.second) < 30);
    QVERIFY(apart(places().first, turned.second) > 2 * apart(turned.first, turned.second));
    wheel(scene3d(), turned.second, -3);
    QVERIFY(apart(places().first, turned.first) < 1 && apart(places().second, turned.second) < 1);
    // A point in the plane of the middle moves with the pointer.
    QVERIFY(part(Qt::Key_2));
    const Vec3 centre = middle_of_the_view();
    const QPointF at = view().to_widget(centre);
    mouse(scene3d(), QEvent::MouseButtonPress, at, Qt::MiddleButton);
    for (const double t : {0.5, 1.0})
      mouse(scene3d(), QEvent::MouseMove, at + t * QPointF(60, -40), Qt::MiddleButton);
    mouse(scene3d(), QEvent::MouseButtonRelease, at + QPointF(60, -40), Qt::MiddleButton);
    const QPointF moved = view().to_widget(centre);
    QVERIFY2(apart(moved, at + QPointF(60, -40)) < 6,
             qPrintable(QString("%1, %2").arg(moved.x() - at.x()).arg(moved.y() - at.y())));
  }

  void translucentThingsAreSortedAtRestAlone() {
    QVERIFY(open_example("lenslets-30"));
    auto* const widget = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
    vtkRenderer& renderer = *widget->renderWindow()->GetRenderers()->GetFirstRenderer();
    const QPointF middle = scene3d()->rect().center();
    QVERIFY(renderer.GetUseDepthPeeling() != 0);
    mouse(scene3d(), QEvent::MouseButtonPress, middle, Qt::LeftButton);
    mouse(scene3d(), QEvent::MouseMove, middle + QPointF(60, 0), Qt::LeftButton);
    QVERIFY(renderer.GetUseDepthPeeling() == 0 && renderer.GetPass());
    mouse(scene3d(), QEvent::MouseButtonRelease, middle + QPointF(60, 0), Qt::LeftButton);
    QVERIFY(renderer.GetUseDepthPeeling() != 0 && !renderer.GetPass());
  }

  void whatWasAimedAtFitsEachSizeOfTheView() {
    QVERIFY(open_example("lenslets-30"));
    child<QAction>("shortenGaps")->setChecked(false);  // to scale
    // Corners of the camera's front and of the flame: all seen, and not much smaller than could be.
    const auto fits = [&] {
      const Box box = scene().medium->bounds();
      std::vector<Vec3> corners{world({0, 0, 0}), world({0, 0, scene().camera.sensor()})};
      for (const double x : {box.lower.x, box.upper.x})
        for (const double y : {box.lower.y, box.upper.y})
          for (const double z : {box.lower.z, box.upper.z}) corners.push_back({x, y, z});
      view().picture();
      QRectF seen;
      for (const Vec3& corner : corners)
        seen = seen.united(QRectF(view().to_widget(corner), QSizeF(1e-3, 1e-3)));
      const QRectF room = scene3d()->rect();
      return room.contains(seen) &&
             std::max(seen.width() / room.width(), seen.height() / room.height()) > 0.6;
    };
    const auto resize = [&](QSize size) {
      window_->resize(size);
      return until([&] { return window_->size() == size; }) && settled();
    };
    QVERIFY(part(Qt::Key_1));
    QVERIFY(fits());
    for (const QSize size : {QSize(1580, 980), QSize(1280, 720), QSize(1400, 900)}) {
      QVERIFY(resize(size));
      QVERIFY2(fits(), qPrintable(QString::number(size.width())));
    }
    // Along an axis it stays along that axis.
    QTest::mouseClick(child<QToolButton>("alongY"), Qt::LeftButton);
    const double height = view().view_height();
    QVERIFY(resize({1280, 720}));
    QVERIFY(std::fabs(view().view_height() / height - 1) > 1e-3);
    QVERIFY(fits());
    auto* const widget = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
    std::array<double, 3> way{};
    vtkRenderer* const renderer = widget->renderWindow()->GetRenderers()->GetFirstRenderer();
    renderer->GetActiveCamera()->GetDirectionOfProjection(way.data());
    QVERIFY(way[1] < -1 + 1e-9);
    // Somebody who came closer stays where he is.
    wheel(scene3d(), scene3d()->rect().center(), 3);
    const double close = view().view_height();
    QVERIFY(resize({1580, 980}));
    QVERIFY(std::fabs(view().view_height() / close - 1) < 1e-9);
    // So does somebody who rolled it about its own direction.
    QVERIFY(part(Qt::Key_1));
    const QPointF middle = scene3d()->rect().center();
    const Vec3 corner = scene().medium->bounds().upper;
    const auto turn = [](const QPointF& a) { return std::atan2(a.y(), a.x()); };
    const double before = turn(view().to_widget(corner) - middle);
    drag(scene3d(), middle + QPointF(0, 100), middle + QPointF(100, 0), Qt::ControlModifier);
    const QPointF rolled = view().to_widget(corner) - middle;
    QVERIFY(std::fabs(std::remainder(turn(rolled) - before, 2 * std::numbers::pi)) > 0.5);
    QVERIFY(resize({1400, 900}));
    view().picture();
    const QPointF now = view().to_widget(corner) - QPointF(scene3d()->rect().center());
    QVERIFY2(std::fabs(turn(now) - turn(rolled)) < 0.01,
             qPrintable(QString::number(turn(now) - turn(rolled))));
  }

  void nothingIsCutOffOverSixOrdersOfMagnitude() {
    QVERIFY(open_example("paper-previous-60x60"));
    // Its lines make the panel higher, and the view lower: what is compared has one size.
    QVERIFY(until(
        [&] { return session().design().result() && session().design().result()->complete; }));
    child<QAction>("shortenGaps")->setChecked(false);  // to scale
    // Above the axes cube and the scale bar.
    const auto something_is_drawn = [&] {
      const QImage picture = view().picture();
      int drawn = 0, all = 0;
      for (int y = 0; y < 3 * picture.height() / 4; y += 5)
        for (int x = 0; x < picture.width(); x += 5, ++all)
          drawn += is_background(picture.pixel(x, y)) ? 0 : 1;
      return drawn > all / 50;
    };
    QVERIFY(part(Qt::Key_1));
    const double whole = view().view_height();
    const QSize size = scene3d()->size();
    for (const Qt::Key key : {Qt::Key_3, Qt::Key_4, Qt::Key_5}) {
      QVERIFY(part(key));
      QVERIFY2(something_is_drawn(), qPrintable(QString::number(view().view_height())));
    }
    QVERIFY2(view().view_height() < 1e-2 * whole,
             qPrintable(QString("%1 of %2").arg(view().view_height()).arg(whole)));
    while (view().view_height() > 1e-6 * whole) {
      const double before = view().view_height();
      for (int i = 0; i < 8; ++i) wheel(scene3d(), scene3d()->rect().center(), 1);
      QVERIFY(view().view_height() < 0.9 * before);
      const auto [near, far] = view().clipping_range();
      QVERIFY(near < 0.1 * view().view_height() && far > 100 * view().view_height());
    }
    const QImage picture = view().picture();
    // The sensor behind fills the view.
    int empty = 0;
    for (int y = 20; y < picture.height() - 20; y += 10)
      for (int x = 20; x < picture.width() - 20; x += 10)
        empty += is_background(picture.pixel(x, y)) ? 1 : 0;
    QCOMPARE(empty, 0);
    // Ctrl+1 leads back to the whole scene.
    QVERIFY(part(Qt::Key_1));
    QVERIFY2(std::fabs(view().view_height() / whole - 1) < 1e-6,
             qPrintable(QString("%1 of %2; %3 x %4 after %5 x %6")
                            .arg(view().view_height())
                            .arg(whole)
                            .arg(scene3d()->width())
                            .arg(scene3d()->height())
                            .arg(size.width())
                            .arg(size.height())));
  }

  void sectionShowsTheFlameAndTheLensAndTurns() {
    QVERIFY(open_example("lenslets-30"));
    const QImage shown = section().grab().toImage();
    const auto at = [&](double z, double height) {
      return shown.pixel(section().to_widget(z, height).toPoint());
    };
    const QRgb back = at(0.5, 0.02);
    // The medium is seen at the places at which it absorbs, and nowhere else; without the border,
    // which is smooth.
    int inside = 0, outside = 0, wrong = 0;
    for (double z = 0.94; z < 1.06; z += 0.004)
      for (double height = -0.045; height < 0.045; height += 0.004) {
        if (!section()
                 .rect()
                 .adjusted(3, 3, -3, -3)
                 .contains(section().to_widget(z, height).toPoint()))
          continue;
        const auto absorbs = [&](double dz, double dh) {
          const MediumSample here = scene().medium->sample(world({0, -height - dh, z + dz}));
          return here.absorption > 0;
        };
        const bool in = absorbs(0, 0);
        bool border = false;
        for (const double d : {-0.004, 0.004}) border |= absorbs(d, 0) != in || absorbs(0, d) != in;
        if (border || std::fabs(height) < 0.003) continue;  // the axis is drawn
        (in ? inside : outside) += 1;
        wrong += (at(z, height) != back) == in ? 0 : 1;
      }
    QVERIFY2(inside > 20 && outside > 20, qPrintable(QString("%1 %2").arg(inside).arg(outside)));
    QVERIFY2(wrong <= 0.02 * (inside + outside), qPrintable(QString::number(wrong)));
    QVERIFY(part(Qt::Key_3));
    const QImage camera = section().grab().toImage();
    const QPoint vertex = section().to_widget(0, 0.004).toPoint();
    int ink = 0;
    for (int x = -3; x <= 3; ++x)
      ink += camera.pixel(vertex + QPoint(x, 0)) != camera.pixel(3, 3) ? 1 : 0;
    QVERIFY(ink > 0);
    // Seen from above the microlenses beside the axis are others.
    QVERIFY(part(Qt::Key_4));
    const auto lens_at = [&](double height) {
      const QPoint place =
          section()
              .to_widget(0.5 * (scene().camera.array_front() + scene().camera.sensor()), height)
              .toPoint();
      QTest::mouseClick(&section(), Qt::LeftButton, {}, place);
      return selection().lens;
    };
    const double pitch = scene().scene.camera.array.pitch;
    QVERIFY(lens_at(1.8 * pitch) == scene().camera.lattice().nearest({0, -1.8 * pitch}));
    const QImage before = section().grab().toImage();
    QVERIFY(click_menu({"View", "Section seen from above"}));
    QVERIFY(lens_at(1.8 * pitch) == scene().camera.lattice().nearest({1.8 * pitch, 0}));
    QVERIFY(difference(before, section().grab().toImage()) > 1e-3);
  }

  void pointerIsDescribedInEveryView() {
    QVERIFY(open_example("lenslets-30"));
    // In the section: temperature and absorption of the flame there.
    const double height = 0.004;
    const MediumSample there = scene().medium->sample(world({0, -height, 1.0}));
    QVERIFY(there.absorption > 0);
    hover(&section(), section().to_widget(1.0, height));
    const auto kelvin = [&] {
      const QString text = pointed().section(';', 1).section(',', 0, 0).trimmed();
      return text.isEmpty() ? 0.0 : parse_quantity(text.toStdString(), Dimension::temperature);
    };
    QVERIFY2(std::fabs(kelvin() / there.temperature - 1) < 0.05, qPrintable(pointed()));
    QVERIFY(pointed().contains("above") && pointed().contains("in front"));
    QEvent leave(QEvent::Leave);
    QApplication::sendEvent(&section(), &leave);
    QVERIFY(pointed().isEmpty());
    // In 3-D: the flame, a pixel, a microlens.
    QVERIFY(part(Qt::Key_2));
    hover(scene3d(), seen_at(world({0, 0, 1.0})));
    QVERIFY2(kelvin() > 300, qPrintable(pointed()));
    QVERIFY(part(Qt::Key_3));
    hover(scene3d(), seen_at(pixel_in_world(210, 90)));
    QVERIFY2(pointed().startsWith("pixel 2"), qPrintable(pointed()));
    QVERIFY(part(Qt::Key_4));
    const Vec2 centre = scene().camera.lattice().centre({-1, 0});
    hover(scene3d(), seen_at(world({centre.x, centre.y, scene().camera.array_front()})));
    QVERIFY2(pointed().contains("microlens (-1, 0), type"), qPrintable(pointed()));
    hover(&section(), section().to_widget(scene().camera.array_front(), 0));
    QVERIFY2(pointed().startsWith("microlens ("), qPrintable(pointed()));
    QVERIFY(selection().kind == Selection::Kind::none);
  }

  void imageIsMovedAndPixelsShowTheirValues() {
    QVERIFY(open_example("lenslets-30"));
    const auto ink_in_the_middle = [&] {
      const QImage shown = image().grab().toImage();
      const QPointF middle = image().to_image(QPointF(image().rect().center()));
      const double column = std::floor(middle.x()), row = std::floor(middle.y());
      const QPoint a = image().to_widget({column, row}).toPoint() + QPoint(3, 3),
                   b = image().to_widget({column + 1, row + 1}).toPoint() - QPoint(3, 3);
      int ink = 0;
      for (int y = a.y(); y < b.y(); ++y)
        for (int x = a.x(); x < b.x(); ++x) ink += shown.pixel(x, y) != shown.pixel(a) ? 1 : 0;
      return ink;
    };
    while (image().scale() < 30) QTest::keyClick(&image(), Qt::Key_Plus);
    QVERIFY(image().scale() < 50);
    QCOMPARE(ink_in_the_middle(), 0);
    while (image().scale() < 60) QTest::keyClick(&image(), Qt::Key_Plus);
    QVERIFY(ink_in_the_middle() > 20);  // figures
    const QPointF from(200, 150), way(-70, 45), before = image().to_image(from);
    drag(&image(), from, from + way);
    const QPointF after = image().to_image(from + way);
    QVERIFY(std::hypot(after.x() - before.x(), after.y() - before.y()) < 1e-6);
    QVERIFY(selection().kind == Selection::Kind::none);
  }

  void largestSensorIsShownDownToItsPixels() {
    session().set_auto_render(false);
    session().document().open_text(
        "[camera]\npreset = \"raytrix-r29\"\n[[flames]]\npreset = \"paper-layered\"\n"
        "position = [\"1 m\", \"0 m\", \"-29 mm\"]\n",
        "r29.toml");
    QVERIFY(click_menu({"File", "Welcome page"}));  // to and fro
    const SensorSpec& sensor = session().document().scene().camera.sensor;
    QCOMPARE(sensor.columns * sensor.rows, 6576 * 4384);
    auto field = std::make_shared<LightField>();
    field->sensor_width = sensor.columns;
    field->sensor_height = sensor.rows;
    field->window = {0, 0, sensor.columns, sensor.rows};
    field->channels.push_back({"total", Image(sensor.columns, sensor.rows), {}});
    Image& values = field->channels[0].flux;
    const auto value = [](int column, int row) {
      return 1e-9F * static_cast<float>((7 * column + 13 * row) % 256);
    };
    for (int row = 0; row < sensor.rows; ++row)
      for (int column = 0; column < sensor.columns; ++column)
        values.at(column, row) = value(column, row);
    session().document().set_image(field);
    QVERIFY(until([&] { return window_->image_panel().pyramid() != nullptr; }));
    QVERIFY(image().isVisible());
    QTest::keyClick(&image(), Qt::Key_F);
    QVERIFY(image().scale() < 0.3);
    for (int i = 0; i < 60 && image().scale() < 12; ++i) wheel(&image(), {137, 252}, 1);
    drag(&image(), QPointF(100, 100), QPointF(160, 140));
    const ToneTable table(image().tone_settings());
    const QImage shown = image().grab().toImage();
    for (const QPoint& at : {QPoint(40, 60), QPoint(150, 170), QPoint(290, 80)}) {
      const QPointF place = image().to_image(QPointF(at));
      const int column = static_cast<int>(place.x()), row = static_cast<int>(place.y());
      QTest::mouseClick(&image(), Qt::LeftButton, {}, at);
      QCOMPARE(selection().column, column);
      QCOMPARE(selection().row, row);
      hover(&image(), at);
      QVERIFY2(pointed().startsWith(QString("pixel %1, %2 ").arg(column).arg(row)),
               qPrintable(pointed()));
    }
    // Many pixels, as they are.
    int alike = 0, compared = 0;
    for (int y = 4; y < shown.height(); y += 9)
      for (int x = 4; x < shown.width(); x += 9) {
        const QPointF place = image().to_image(QPointF(x + 0.5, y + 0.5));
        const double u = place.x() - std::floor(place.x()), v = place.y() - std::floor(place.y());
        if (std::min({u, v, 1 - u, 1 - v}) < 0.2) continue;  // the lines between pixels
        const QColor meant(table(value(static_cast<int>(place.x()), static_cast<int>(place.y()))));
        ++compared;
        alike += std::abs(QColor(shown.pixel(x, y)).red() - meant.red()) <= 2 ? 1 : 0;
      }
    QVERIFY2(compared > 100 && alike > 0.98 * compared,
             qPrintable(QString("%1 of %2").arg(alike).arg(compared)));
  }

  void outlinesHaveTheColoursOfTheirTypes() {
    QVERIFY(open_example("lenslets-30"));
    image().set_scale(12);
    image().centre_on(150, 150);
    QTest::keyClick(&image(), Qt::Key_O);
    QVERIFY(until([&] { return session().light_field().outlines() != nullptr; }));
    // Only where they are: their white light, which takes long, is not asked for.
    QVERIFY(session().light_field().micro_images() == nullptr);
    QCoreApplication::processEvents();
    const QImage shown = image().grab().toImage();
    const MicroImages micro(scene().camera, false);
    const double pitch = scene().scene.camera.sensor.pixel_pitch;
    QSet<int> types;
    for (const LensIndex lens :
         {LensIndex{0, 0}, LensIndex{-1, 0}, LensIndex{0, 1}, LensIndex{-1, 1}, LensIndex{0, -1}}) {
      const MicroImages::Place place = micro.place(lens);
      const QColor meant = type_colour(place.type);
      int found = 0, looked = 0;
      for (int k = 0; k < 24; ++k) {
        const double angle = 0.2618 * k;
        const QPointF rim =
            image().to_widget({150 - (place.centre.x + place.radius * std::cos(angle)) / pitch,
                               150 - (place.centre.y + place.radius * std::sin(angle)) / pitch});
        if (!image().rect().adjusted(3, 3, -3, -3).contains(rim.toPoint())) continue;
        ++looked;
        int least = 1000;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const QColor c(shown.pixel(rim.toPoint() + QPoint(dx, dy)));
            least = std::min(least, std::abs(c.red() - meant.red()) +
                                        std::abs(c.green() - meant.green()) +
                                        std::abs(c.blue() - meant.blue()));
          }
        found += least < 60 ? 1 : 0;
      }
      QVERIFY2(looked > 12 && found > 0.7 * looked,
               qPrintable(QString("%1 of %2, type %3").arg(found).arg(looked).arg(place.type)));
      types << place.type;
    }
    QCOMPARE(types.size(), 3);
  }

  void tableOfRaysHasTheFiguresOfItsRays() {
    QVERIFY(open_example("lenslets-30"));
    Pixel bright{150, 150};
    for (int row = 100; row < 200; ++row)
      for (int column = 100; column < 200; ++column)
        if (flux().at(column, row) > flux().at(bright.column, bright.row)) bright = {column, row};
    image().set_scale(4);
    image().centre_on(150, 150);
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(bright.column, bright.row));
    QVERIFY(until([&] {
      return session().rays().rays() && session().rays().rays()->selection == selection();
    }));
    const RayPaths& paths = session().rays().rays()->paths;
    auto* table = child<QTableWidget>("raysTable");
    QCOMPARE(static_cast<std::size_t>(table->rowCount()), paths.rays.size());
    const auto close = [](double a, double b) { return std::fabs(a - b) <= 6e-4 * std::fabs(b); };
    int thick = 0;
    for (int row = 0; row < table->rowCount(); ++row) {
      const auto number = static_cast<std::size_t>(table->item(row, 0)->data(Qt::UserRole).toInt());
      const RayPath& ray = paths.rays[number];
      QVERIFY(close(table->item(row, 6)->text().toDouble(), ray.optical_thickness));
      QVERIFY(close(table->item(row, 7)->text().toDouble(), paths.radiance_of(number, 0)));
      QVERIFY(close(table->item(row, 8)->text().toDouble(), ray.weight));
      const Vec3 way = normalize(paths.vertices[ray.first + 1].position -
                                 paths.vertices[ray.first].position),
                 axis = normalize(session().document().scene().camera.look_direction);
      const double angle = std::atan2(length(cross(way, axis)), dot(way, axis));
      const double stated =
          parse_quantity(table->item(row, 4)->text().toStdString(), Dimension::angle);
      QVERIFY2(std::fabs(stated / angle - 1) < 6e-3, qPrintable(table->item(row, 4)->text()));
      thick += ray.optical_thickness > 0 ? 1 : 0;
    }
    QVERIFY(thick > 4);
    // The surfaces of the chosen one, in order away from the sensor.
    auto* surfaces = child<QTableWidget>("surfacesTable");
    double last = -1;
    for (int row = 0; row < surfaces->rowCount(); ++row) {
      const double distance =
          parse_quantity(surfaces->item(row, 1)->text().toStdString(), Dimension::length);
      QVERIFY(distance >= last);
      last = distance;
    }
    QVERIFY(surfaces->rowCount() > 4);
    // Return goes to the pixel of the ray.
    table->setFocus();
    QTest::keyClick(table, Qt::Key_Return);
    QCOMPARE(selection().column, bright.column);
    QCOMPARE(selection().row, bright.row);
  }

  void sliceIsALineOfEveryView() {
    QVERIFY(window_->open_example("paper-previous-60x60"));
    show_tab(LightFieldPanel::Tab::views);
    QVERIFY(settled());
    QVERIFY(until([&] { return session().light_field().views() != nullptr; }));
    show_tab(LightFieldPanel::Tab::slice);
    const Views& views = *session().light_field().views();
    auto* line = child<QSlider>("lineSlider");
    const auto compare = [&](bool vertical) {
      const Image& slice = child<ImageView>("epipolarView")->image()->level(0);
      constexpr int kGrid = LightFieldJobs::kGrid;
      const int thick = slice.height / kGrid;
      for (int v = 0; v < kGrid; ++v)
        for (int i = 0; i < slice.width; i += 3) {
          const auto place =
              static_cast<std::size_t>(vertical ? v * kGrid + kGrid / 2 : kGrid / 2 * kGrid + v);
          const Image& view_image = views.views[place].image;
          const float there =
              vertical ? view_image.at(line->value(), i) : view_image.at(i, line->value());
          if (slice.at(i, v * thick) != there) return false;
        }
      return true;
    };
    QVERIFY(compare(false));
    QTest::keyClick(line, Qt::Key_Right);
    QVERIFY(compare(false));
    QTest::keyClick(child<QComboBox>("sliceDirection"), Qt::Key_Down);
    QVERIFY(compare(true));
  }

 private:
  /// The point in the middle of the view.
  Vec3 middle_of_the_view() {
    auto* const widget = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
    vtkRenderer* const renderer = widget->renderWindow()->GetRenderers()->GetFirstRenderer();
    const double* const p = renderer->GetActiveCamera()->GetFocalPoint();
    return {p[0], p[1], p[2]};
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_views_test() {
  return std::make_unique<ViewsTest>();
}

#include "views_test.moc"

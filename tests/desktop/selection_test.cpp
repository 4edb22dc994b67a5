// A selection shows everywhere, and can be made everywhere, by real clicks. References:
// the camera's frame as docs/reference defines it, written out here. Runs on a screen of double
// density, too: places on widgets are logical pixels, what VTK draws is not.
#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkMapper.h>
#include <vtkPolyData.h>
#include <vtkPropCollection.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>

#include <QFile>
#include <QSet>
#include <QTableWidget>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "gui_tests.h"
#include "plenoflame/lightfield/micro_images.h"
#include "scene_fixture.h"
#include "widgets/image/image_view.h"
#include "widgets/panels/rays_panel.h"

using namespace plenoflame;
using namespace plenoflame::desktop;
using plenoflame::desktop::test::difference;

class SelectionTest : public test::SceneFixture {
  Q_OBJECT

  QTableWidget* table() { return child<QTableWidget>("raysTable"); }
  bool rays_are_there() {
    return until([this] {
             return session().rays().rays() && session().rays().rays()->selection == selection();
           }) &&
           settled();  // and drawn, with the microlenses near them
  }
  void open_small() { QVERIFY(open_example("lenslets-30")); }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void pixelOfTheImageIsTheOneUnderThePointer() {
    open_small();
    const double ratio = qEnvironmentVariable("QT_SCALE_FACTOR", "1").toDouble();
    QCOMPARE(image().devicePixelRatioF(), ratio);
    image().set_scale(16 * ratio);  // pixels of the device
    image().centre_on(150, 140);
    QTest::qWait(50);
    const QImage shown = image().grab().toImage();
    QCOMPARE(shown.width(), static_cast<int>(std::lround(image().width() * ratio)));
    const ToneTable table(image().tone_settings());
    const Image& flux = session().document().image()->channels[0].flux;
    int compared = 0;
    for (int row = 134; row < 146; row += 3)
      for (int column = 144; column < 156; column += 3) {
        const QPoint at = of_pixel(column, row);
        if (!image().rect().contains(at)) continue;
        QTest::mouseClick(&image(), Qt::LeftButton, {}, at);
        QCOMPARE(selection().column, column);
        QCOMPARE(selection().row, row);
        // The value is the one that is drawn there.
        const QColor drawn(shown.pixel(QPoint(static_cast<int>((at.x() + 0.5) * ratio),
                                              static_cast<int>((at.y() + 0.5) * ratio))));
        const QColor meant(table(flux.at(column, row)));
        QVERIFY(std::abs(drawn.red() - meant.red()) <= 2);
        ++compared;
      }
    QVERIFY(compared > 8);
  }

  void pixelOfTheSensorIsPickedIn3d() {
    open_small();
    QVERIFY(part(Qt::Key_3));
    const QPoint at = seen_at(pixel_in_world(210, 90));
    QVERIFY(scene3d()->rect().contains(at));
    QTest::mouseClick(scene3d(), Qt::LeftButton, {}, at);
    QVERIFY(selection().kind == Selection::Kind::pixel);
    // A place on the screen is a square of the sensor, seen at a slant.
    const double screen_pixel = view().view_height() / scene3d()->height();
    const double reach = 4 * screen_pixel / session().document().scene().camera.sensor.pixel_pitch;
    QVERIFY(reach < 100);
    QVERIFY2(std::hypot(selection().column - 210, selection().row - 90) < reach,
             qPrintable(QString("%1, %2").arg(selection().column).arg(selection().row)));
    QVERIFY(rays_are_there());
  }

  void microlensIsPickedIn3dWithItsImageAndCone() {
    open_small();
    QVERIFY(part(Qt::Key_4));
    const auto& lattice = scene().camera.lattice();
    for (const LensIndex lens : {LensIndex{0, 0}, LensIndex{-1, 0}}) {
      const Vec2 centre = lattice.centre(lens);
      const QPoint at = seen_at(world({centre.x, centre.y, scene().camera.array_front()}));
      QVERIFY(scene3d()->rect().contains(at));
      const QImage image_before = image().grab().toImage(), scene_before = view().picture();
      QTest::mouseClick(scene3d(), Qt::LeftButton, {}, at);
      QVERIFY(selection().kind == Selection::Kind::microlens);
      QCOMPARE(selection().lens.q, lens.q);
      QCOMPARE(selection().lens.r, lens.r);
      QVERIFY(rays_are_there());
      QVERIFY(difference(image_before, image().grab().toImage()) > 1e-4);  // its pixels are marked
      QVERIFY(difference(scene_before, view().picture()) > 1e-4);          // its cone is drawn
      // Its pixels stand where a line from the middle of the exit pupil through it arrives.
      double x = 0;
      for (const Pixel& p : session().rays().rays()->pixels) x += p.column + 0.5;
      x /= static_cast<double>(session().rays().rays()->pixels.size());
      const double pitch = scene().scene.camera.sensor.pixel_pitch;
      QVERIFY(std::fabs(x - (150 - centre.x / pitch)) < 1.5);
    }
  }

  void microlensOfAPixelIsFoundByShiftAndClick() {
    open_small();
    // Lens (0, 0) stands 0.5 mm, that is five pixels, to the left of the middle of the image.
    QTest::mouseClick(&image(), Qt::LeftButton, Qt::ShiftModifier, of_pixel(145, 150));
    QVERIFY(selection().kind == Selection::Kind::microlens);
    QCOMPARE(selection().lens.q, 0);
    QCOMPARE(selection().lens.r, 0);
    QVERIFY(rays_are_there());
    for (int row = 0; row < table()->rowCount(); ++row)
      QVERIFY(table()->item(row, 3)->text().contains("(0, 0)"));
    QTest::mouseClick(&image(), Qt::LeftButton, Qt::ShiftModifier, of_pixel(155, 150));
    QCOMPARE(selection().lens.q, -1);
  }

  void microlensOfAnObliquePixelIsTheOneWhoseImageItIsIn() {
    open_small();
    // The centres of the micro-images, and which is nearest: far from the axis not always that of
    // the microlens straight in front.
    const MicroImages micro(scene().camera, false);
    const MicrolensLattice& lattice = scene().camera.lattice();
    const double pitch = scene().scene.camera.array.pitch;
    int compared = 0;
    for (const int row : {20, 150, 270})
      for (int column = 0; column < 300 && compared < 12; ++column) {
        const Vec2 point = scene().camera.sensor_point(column + 0.5, row + 0.5);
        std::vector<std::pair<double, LensIndex>> near;
        for (const LensIndex lens : lattice.within(point - Vec2{2 * pitch, 2 * pitch},
                                                   point + Vec2{2 * pitch, 2 * pitch})) {
          const MicroImages::Place place = micro.place(lens);
          if (!place.dark) near.emplace_back(length(place.centre - point), lens);
        }
        std::sort(near.begin(), near.end(),
                  [](const auto& a, const auto& b) { return a.first < b.first; });
        if (near.size() < 2 || near[1].first - near[0].first < 0.01 * pitch) continue;
        const LensIndex expected = near[0].second;
        if (expected == lattice.nearest(point)) continue;
        image().set_scale(8);
        image().centre_on(column, row);
        QTest::mouseClick(&image(), Qt::LeftButton, Qt::ShiftModifier, of_pixel(column, row));
        QVERIFY(selection().kind == Selection::Kind::microlens);
        QVERIFY2(selection().lens == expected,
                 qPrintable(QString("pixel %1, %2: lens %3, %4 instead of %5, %6")
                                .arg(column)
                                .arg(row)
                                .arg(selection().lens.q)
                                .arg(selection().lens.r)
                                .arg(expected.q)
                                .arg(expected.r)));
        ++compared;
      }
    QVERIFY2(compared >= 6, qPrintable(QString::number(compared)));
  }

  void microlensIsPickedInTheSection() {
    open_small();
    QVERIFY(part(Qt::Key_4));
    const double front = scene().camera.array_front();
    QTest::mouseClick(&section(), Qt::LeftButton, {}, section().to_widget(front, 0).toPoint());
    QVERIFY(selection().kind == Selection::Kind::microlens);
    QCOMPARE(selection().lens.r, 0);
    QVERIFY(rays_are_there());
  }

  void pointOfTheFlameLightsThePixelsThatSeeIt() {
    open_small();
    // In the section: a point 29 mm below its middle would be the flame's foot; the axis is in it.
    const Vec3 point = world({0, 0, 1.0});
    QTest::mouseClick(&section(), Qt::LeftButton, {}, section().to_widget(1.0, 0).toPoint());
    QVERIFY(selection().kind == Selection::Kind::point);
    QVERIFY(length(selection().point - point) < 0.02);
    QVERIFY(rays_are_there());
    const auto pixels = session().rays().rays()->pixels;
    QVERIFY(!pixels.empty());
    // Marked in the image: the same picture without the selection differs.
    const QImage marked = image().grab().toImage();
    // From a ray back to its pixel, by the table.
    table()->setFocus();
    int line = 0;
    while (line < table()->rowCount() && table()->item(line, 1)->text().isEmpty()) ++line;
    QVERIFY(line < table()->rowCount());
    table()->setCurrentCell(line, 0);
    const QString text = table()->item(line, 1)->text();
    const QPoint cell = table()->visualItemRect(table()->item(line, 0)).center();
    QTest::mouseClick(table()->viewport(), Qt::LeftButton, {}, cell);
    QTest::mouseDClick(table()->viewport(), Qt::LeftButton, {}, cell);
    QVERIFY(selection().kind == Selection::Kind::pixel);
    QCOMPARE(QString("%1, %2").arg(selection().column).arg(selection().row), text);
    QVERIFY(rays_are_there());
    QVERIFY(difference(marked, image().grab().toImage()) > 1e-5);
    // Its rays pass the point within what a pixel covers there.
    double nearest = 1;
    const SelectedRays& back = *session().rays().rays();
    for (const RayPath& ray : back.paths.rays) {
      if (ray.status.status != RayStatus::reached || ray.count < 2) continue;
      const Vec3 a = back.paths.vertices[ray.first + ray.count - 2].position,
                 b = back.paths.vertices[ray.first + ray.count - 1].position;
      nearest = std::min(nearest, length(cross(point - a, normalize(b - a))));
    }
    QVERIFY(nearest < 0.03);
  }

  void pointOfTheFlameIsPickedIn3d() {
    open_small();
    QVERIFY(part(Qt::Key_2));
    const Vec3 middle = world({0, 0, 1.0});
    QTest::mouseClick(scene3d(), Qt::LeftButton, {}, seen_at(middle));
    QVERIFY(selection().kind == Selection::Kind::point);
    // Somewhere along what is seen there, inside of the flame.
    const QPointF again = view().to_widget(selection().point);
    QVERIFY(std::hypot(again.x() - seen_at(middle).x(), again.y() - seen_at(middle).y()) < 2);
    QVERIFY(length(selection().point - middle) < 0.1);
    QVERIFY(rays_are_there());
  }

  void chosenRayStandsOut() {
    open_small();
    QVERIFY(part(Qt::Key_3));
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(145, 150));
    QVERIFY(rays_are_there());
    QVERIFY(table()->rowCount() > 6);
    const auto choose = [&](int row) {
      const QRect cell = table()->visualItemRect(table()->item(row, 0));
      QTest::mouseClick(table()->viewport(), Qt::LeftButton, {}, cell.center());
      QTest::qWait(80);
      return std::pair(view().picture(), section().grab().toImage());
    };
    table()->scrollToTop();
    const auto first = choose(0);
    QTest::keyClick(table(), Qt::Key_Down);
    QTest::keyClick(table(), Qt::Key_Down);
    QTest::qWait(80);
    const QImage other_scene = view().picture(), other_section = section().grab().toImage();
    QVERIFY(difference(first.first, other_scene) > 1e-5);
    QVERIFY(difference(first.second, other_section) > 1e-5);
    QTest::keyClick(table(), Qt::Key_Home, Qt::ControlModifier);
    QTest::qWait(80);
    QCOMPARE(difference(first.second, section().grab().toImage()), 0.0);
    QCOMPARE(difference(first.first, view().picture()), 0.0);
    // The surfaces that it meets, from the sensor on.
    auto* surfaces = child<QTableWidget>("surfacesTable");
    QCOMPARE(surfaces->item(0, 0)->text(), QString("sensor"));
    QVERIFY(surfaces->rowCount() > 4);
  }

  void raysAreColouredByHowTheyEnd() {
    open_small();
    // A pixel at the corner: some rays are stopped.
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(40, 40));
    QVERIFY(rays_are_there());
    QSet<QString> colours, ends;
    for (int row = 0; row < table()->rowCount(); ++row) {
      const QTableWidgetItem* const item = table()->item(row, 2);
      colours << item->foreground().color().name();
      ends << item->text().section(' ', 0, 0);
    }
    QVERIFY(!ends.isEmpty());
    QCOMPARE(colours.size(), ends.size());
  }

  // The first ray that arrives is shown. Rays before it may be stopped.
  void firstChosenRayArrives() {
    open_small();
    const auto arrives = [this](int ray) {
      return session().rays().rays()->paths.rays[static_cast<std::size_t>(ray)].status.status ==
             RayStatus::reached;
    };
    int stopped = 0;
    for (int place = 20; place < 280; place += 10) {
      QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(place, 40));
      QVERIFY(rays_are_there());
      const int count = table()->rowCount();
      int first = 0;
      while (first < count && !arrives(first)) ++first;
      if (first == count || count == 0) continue;
      QCOMPARE(table()->currentRow(), first);
      QCOMPARE(window_->rays_panel().chosen(), first);
      stopped += first > 0 ? 1 : 0;
    }
    QVERIFY(stopped > 0);
  }

  void raysIn3dHaveTheColourOfTheirTypeOrEnd() {
    open_small();
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(40, 40));
    QVERIFY(rays_are_there());
    QVERIFY(settled());
    // The table's words for each ray, by colours that raysAreColouredByHowTheyEnd() checks.
    const RayPaths& paths = session().rays().rays()->paths;
    std::vector<QColor> colours;
    QSet<QString> different;
    for (int row = 0; row < table()->rowCount(); ++row) {
      QCOMPARE(table()->item(row, 0)->data(Qt::UserRole).toInt(), row);
      colours.push_back(table()->item(row, 2)->foreground().color());
      different << colours.back().name();
    }
    QVERIFY(different.size() >= 2);
    // Lines of the view, to scale, each with a colour of its own.
    child<QAction>("shortenGaps")->setChecked(false);
    auto* const widget = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
    vtkPropCollection* const props =
        widget->renderWindow()->GetRenderers()->GetFirstRenderer()->GetViewProps();
    std::size_t found = 0;
    for (int i = 0; i < props->GetNumberOfItems(); ++i) {
      auto* const actor = vtkActor::SafeDownCast(props->GetItemAsObject(i));
      auto* const lines =
          actor ? vtkPolyData::SafeDownCast(actor->GetMapper()->GetInputAsDataSet()) : nullptr;
      if (!lines || lines->GetNumberOfLines() != static_cast<vtkIdType>(paths.rays.size()))
        continue;
      QVERIFY(actor->GetVisibility() && actor->GetMapper()->GetScalarVisibility());
      for (std::size_t ray = 0; ray < paths.rays.size(); ++ray) {
        const auto cell = static_cast<vtkIdType>(ray);
        std::array<double, 3> end{}, ink{};
        vtkCell* const line = lines->GetCell(cell);
        line->GetPoints()->GetPoint(line->GetNumberOfPoints() - 1, end.data());
        lines->GetCellData()->GetScalars()->GetTuple(cell, ink.data());
        const RayPath& path = paths.rays[ray];
        const Vec3 last = paths.vertices[path.first + path.count - 1].position;
        QVERIFY(length(last - Vec3{end[0], end[1], end[2]}) < 1e-6 * length(last));
        const QColor drawn(static_cast<int>(ink[0]), static_cast<int>(ink[1]),
                           static_cast<int>(ink[2]));
        if (path.status.status == RayStatus::reached)  // lighter than in print, of the same hue
          QVERIFY(std::abs(drawn.hue() - type_colour(path.type).hue()) <= 2);
        else
          QCOMPARE(drawn.rgb(), status_colour(path.status.status, true).rgb());  // on dark ground
        ++found;
      }
    }
    QCOMPARE(found, paths.rays.size());
  }

  void distanceIsMeasuredBetweenTwoClicks() {
    open_small();
    for (const Qt::Key key : {Qt::Key_1, Qt::Key_4}) {  // a metre, and a millimetre
      QVERIFY(part(key));
      QAction* const measure = child<QAction>("measure");
      measure->trigger();
      QTest::qWait(80);
      const QPoint a = scene3d()->rect().center() - QPoint(60, 20), b = a + QPoint(110, 40);
      for (const QPoint& p : {a, b}) {
        mouse(scene3d(), QEvent::MouseMove, p, Qt::NoButton);
        QTest::mouseClick(scene3d(), Qt::LeftButton, {}, p);
        QTest::qWait(60);
      }
      const double expected = std::hypot(110, 40) * view().view_height() / scene3d()->height();
      QVERIFY2(std::fabs(view().measured() / expected - 1) < 0.03,
               qPrintable(QString("%1 for %2").arg(view().measured()).arg(expected)));
      QVERIFY(selection().kind == Selection::Kind::none);  // these clicks measure only
      measure->trigger();
      QCOMPARE(view().measured(), 0.0);
    }
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_selection_test() {
  return std::make_unique<SelectionTest>();
}

#include "selection_test.moc"

// The camera as an object in the 3-D view, and the flame beside the axes. References: places of
// lens, sensor and flame in the world, and the ground behind them.
#include <QColor>
#include <QComboBox>
#include <QToolButton>
#include <algorithm>
#include <array>
#include <cmath>

#include "gui_tests.h"
#include "scene_fixture.h"
#include "widgets/scene/lens_detail.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class ObjectTest : public test::SceneFixture {
  Q_OBJECT

  /// Chooses an entry of the list behind the last button above the view.
  void choose_housing(const QString& text) {
    QTest::mouseClick(child<QToolButton>("moreOfScene"), Qt::LeftButton);
    auto* const list = child<QComboBox>("cameraHousing");
    QVERIFY(list->isVisible());
    list->setFocus();
    QTest::keyClick(list, Qt::Key_Home);
    while (list->currentText() != text && list->currentIndex() + 1 < list->count())
      QTest::keyClick(list, Qt::Key_Down);
    QCOMPARE(list->currentText(), text);
    QTest::keyClick(list->window(), Qt::Key_Escape);
  }
  QColor seen(const QImage& picture, Vec3 place) {
    return picture.pixelColor((scene3d()->devicePixelRatioF() * view().to_widget(place)).toPoint());
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void housingIsCutOpenClosedAndLeftAway() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_3));
    const double sensor = scene().camera.sensor();
    const Vec3 middle = world({0, 0, 0.5 * sensor}), pixel = pixel_in_world(150, 150);
    const auto picture = [&](const char* housing) {
      choose_housing(housing);
      QTest::keyClick(window_.get(), Qt::Key_3, Qt::ControlModifier);  // aims at it
      return view().picture();
    };
    const QColor ground = QColor::fromRgb(view().picture().pixel(4, 4));
    const QImage none = picture("No housing");
    QCOMPARE(seen(none, middle), ground);
    const QColor bare = seen(none, pixel);
    QVERIFY(bare != ground);
    // Its back is behind the middle of the camera, its sensor is seen.
    const QImage open = picture("Housing cut open");
    QVERIFY(seen(open, middle) != ground);
    QVERIFY(std::abs(seen(open, pixel).lightness() - bare.lightness()) < 40);
    const QImage closed = picture("Housing closed");
    QVERIFY(seen(closed, middle) != ground);
    QVERIFY(test::difference(open, closed) > 0.02);
    // The cut faces are the brightest parts of metal.
    const auto bright = [](const QImage& image) {
      int count = 0;
      for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width() * 85 / 100; ++x) {
          const QColor c = image.pixelColor(x, y);
          count += c.lightness() > 150 && c.blue() - c.red() < 40 ? 1 : 0;
        }
      return count;
    };
    QVERIFY2(bright(open) > 4 * bright(closed),
             qPrintable(QString("%1 %2").arg(bright(open)).arg(bright(closed))));
    // Microlenses are seen without it.
    QVERIFY(part(Qt::Key_4));
    const QImage near = view().picture();
    choose_housing("No housing");
    QVERIFY(test::difference(near, view().picture()) < 1e-3);
  }

  void glassMirrorsTheWindowsOfARoom() {
    QVERIFY(open_example("lenslets-30"));
    choose_housing("No housing");
    QVERIFY(part(Qt::Key_3));
    const QImage picture = view().picture();
    const QRect lens =
        QRectF(view().to_widget(world({0, -0.05, 0})), view().to_widget(world({0, 0.05, -0.02})))
            .normalized()
            .adjusted(-10, 0, 10, 0)
            .toRect();
    int white = 0;
    for (int y = lens.top(); y <= lens.bottom(); ++y)
      for (int x = lens.left(); x <= lens.right(); ++x)
        white += qGray(picture.pixel(x, y)) > 140 ? 1 : 0;
    QVERIFY2(white > 20, qPrintable(QString::number(white)));
  }

  /// The wheel alone, over the array, leads from the whole scene to the microlenses.
  void wheelLeadsToTheMicrolensesOfThreeTypes() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_1));
    // Middles by arithmetic: 1 mm apart in a hexagonal lattice, half a pitch beside the axis.
    const double front = scene().camera.array_front(), row = std::sqrt(0.75);
    const auto middle = [&](int q, int r) {
      return world({1e-3 * (q + 0.5 * r + 0.5), 1e-3 * row * r, front});
    };
    const auto seen_far = [&](double across) {
      const QPointF step = view().to_widget(middle(-1, 2)) - view().to_widget(middle(0, 0));
      return std::hypot(step.x(), step.y()) > across * 2 * row;
    };
    for (int i = 0; i < 60 && !seen_far(40); ++i) {
      wheel(scene3d(), view().to_widget(middle(0, 0)), 1);
      QVERIFY(settled());
    }
    QVERIFY(seen_far(40));
    const double height = view().view_height();
    wheel(scene3d(), {20, 20}, 0, 1);
    QCOMPARE(view().view_height(), height);
    const QImage picture = view().picture();
    if (const QString folder = qEnvironmentVariable("PLENOFLAME_TOUR"); !folder.isEmpty())
      picture.save(folder + "/wheel.png");
    std::array<int, 3> all{}, right{};
    for (int q = -9; q <= 9; ++q)
      for (int r = -9; r <= 9; ++r) {
        const QPointF place = scene3d()->devicePixelRatioF() * view().to_widget(middle(q, r));
        if (!picture.rect().adjusted(10, 10, -10, -60).contains(place.toPoint())) continue;
        const QColor c = picture.pixelColor(place.toPoint());
        const auto type = static_cast<std::size_t>(((q - r) % 3 + 3) % 3);
        // Okabe and Ito: blue, orange, green. The lens before it may cover one's middle.
        const std::array<int, 3> of{c.blue(), c.red(), c.green()};
        ++all[type];
        right[type] += of[type] > std::max(of[(type + 1) % 3], of[(type + 2) % 3]) + 5 ? 1 : 0;
      }
    for (const std::size_t type : {0U, 1U, 2U})
      QVERIFY2(all[type] > 10 && right[type] > 0.7 * all[type],
               qPrintable(QString("%1: %2 of %3").arg(type).arg(right[type]).arg(all[type])));
    // They are glass, in which windows of a room are seen, and no painted plate.
    int white = 0;
    for (int y = 0; y < picture.height() - 60; ++y)
      for (int x = 0; x < picture.width(); ++x) white += qBlue(picture.pixel(x, y)) > 190 ? 1 : 0;
    QVERIFY2(white > 500, qPrintable(QString::number(white)));
  }

  void fewMicrolensesInViewAreNotMadeAnew() {
    QVERIFY(open_example("lenslets-30"));  // 1 mm apart
    const auto seen = [](double size) { return ArrayPart{{0, 0}, {size, size}}; };
    for (const double size : {1e-6, 1e-4, 1e-3, 1e-2})
      QVERIFY(with_margin(seen(size), scene().camera).suits(seen(size), scene().camera));
    QVERIFY(!with_margin(seen(1e-2), scene().camera).suits(seen(1e-4), scene().camera));
  }

  void axesCoverNoFlame() {
    QVERIFY(open_example("lenslets-30"));
    for (const QSize size : {QSize(1366, 768), QSize(1400, 900)}) {
      window_->resize(size);
      QTest::qWait(100);
      QVERIFY(part(Qt::Key_2));
      double metres = 0;
      const QImage bare = view().poster(scene3d()->size(), Qt::black, metres);
      const QImage shown = view().picture();
      int cube = 0, covered = 0;
      for (int y = 0; y < bare.height() * 15 / 100; ++y)
        for (int x = bare.width() * 86 / 100; x < bare.width(); ++x) {
          covered += qRed(bare.pixel(x, y)) > 40 ? 1 : 0;
          cube += qGray(shown.pixel(x, y)) > 40 ? 1 : 0;
        }
      QVERIFY2(cube > 500 && covered == 0, qPrintable(QString("%1 %2").arg(cube).arg(covered)));
    }
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_object_test() {
  return std::make_unique<ObjectTest>();
}

#include "object_test.moc"

// The scene's drawing with shortened gaps, handles, running light; views of one type of microlenses
// and through glass. References: where points of the world lie, the lattice of three types, what
// the command makes of the same picture.
#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkCell.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkPropCollection.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <QDoubleSpinBox>

#include <QAction>
#include <QComboBox>
#include <QDir>
#include <QProgressBar>
#include <QPushButton>
#include <QSpinBox>
#include <QStandardPaths>
#include <QTabWidget>
#include <QToolButton>
#include <cmath>
#include <map>
#include <numbers>

#include "gui_tests.h"
#include "scene_fixture.h"
#include "scenes.h"
#include "widgets/flame/opacity_curve.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/window/film_dialog.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class DrawingTest : public test::SceneFixture {
  Q_OBJECT

  QToolButton* button(const char* action) {
    for (auto* candidate : window_->findChildren<QToolButton*>())
      if (candidate->defaultAction() == child<QAction>(action)) return candidate;
    return nullptr;
  }
  void click(const char* action) {
    QVERIFY(button(action));
    QTest::mouseClick(button(action), Qt::LeftButton);
    QTest::qWait(50);
  }
  static double apart(QPointF a, QPointF b) { return std::hypot(a.x() - b.x(), a.y() - b.y()); }
  Vec3 flame_middle() {
    const Box box = scene().medium->bounds();
    return 0.5 * (box.lower + box.upper);
  }
  /// The texts of the 3-D view, by the graphics library's own measure of its texts, and the
  /// marks of shortened gaps; each with what it is, upwards from the lower left corner [pixel].
  std::vector<std::pair<QString, QRectF>> written_in_3d() {
    auto* const widget = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
    vtkRenderer& renderer = *widget->renderWindow()->GetRenderers()->GetFirstRenderer();
    vtkPropCollection* const props = renderer.GetViewProps();
    std::vector<std::pair<QString, QRectF>> written;
    for (int i = 0; i < props->GetNumberOfItems(); ++i) {
      vtkObject* const prop = props->GetItemAsObject(i);
      if (auto* const text = vtkTextActor::SafeDownCast(prop); text && text->GetVisibility()) {
        std::array<double, 4> box{};
        text->GetBoundingBox(&renderer, box.data());
        const int* const at = text->GetPositionCoordinate()->GetComputedViewportValue(&renderer);
        written.emplace_back(text->GetInput(), QRectF(at[0] + box[0], at[1] + box[2],
                                                      box[1] - box[0], box[3] - box[2]));
      }
      if (auto* const bar = vtkScalarBarActor::SafeDownCast(prop); bar && bar->GetVisibility()) {
        const QSizeF size(renderer.GetSize()[0], renderer.GetSize()[1]);
        const double* const corner = bar->GetPosition();
        written.emplace_back(
            "scale of temperatures",
            QRectF(corner[0] * size.width(), corner[1] * size.height(),
                   bar->GetWidth() * size.width(), bar->GetHeight() * size.height()));
      }
      auto* const actor = vtkActor::SafeDownCast(prop);
      auto* const mapper = actor ? vtkPolyDataMapper::SafeDownCast(actor->GetMapper()) : nullptr;
      vtkPolyData* const data = mapper ? mapper->GetInput() : nullptr;
      if (!data || data->GetNumberOfPoints() != 4 || data->GetNumberOfLines() != 2) continue;
      QPolygonF mark;  // two lines: where the axis is broken
      for (vtkIdType k = 0; k < 4; ++k) {
        const double* const p = data->GetPoint(k);
        renderer.SetWorldPoint(p[0], p[1], p[2], 1);
        renderer.WorldToDisplay();
        mark << QPointF(renderer.GetDisplayPoint()[0], renderer.GetDisplayPoint()[1]);
      }
      written.emplace_back("break", mark.boundingRect());
    }
    return written;
  }
  /// Lines on the screen from texts to their things; the scale bar, of four points, is none.
  std::vector<QLineF> leaders() {
    auto* const widget = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
    vtkPropCollection* const props =
        widget->renderWindow()->GetRenderers()->GetFirstRenderer()->GetViewProps();
    std::vector<QLineF> lines;
    for (int i = 0; i < props->GetNumberOfItems(); ++i) {
      auto* const drawn = vtkActor2D::SafeDownCast(props->GetItemAsObject(i));
      auto* const mapper = drawn ? vtkPolyDataMapper2D::SafeDownCast(drawn->GetMapper()) : nullptr;
      vtkPolyData* const data = mapper ? mapper->GetInput() : nullptr;
      for (vtkIdType k = 0; data && k < data->GetNumberOfCells(); ++k) {
        if (data->GetCell(k)->GetNumberOfPoints() != 2) continue;
        std::array<double, 3> a{}, b{};
        data->GetCell(k)->GetPoints()->GetPoint(0, a.data());
        data->GetCell(k)->GetPoints()->GetPoint(1, b.data());
        lines.emplace_back(a[0], a[1], b[0], b[1]);
      }
    }
    return lines;
  }
  /// Views or refocused pictures are there.
  bool views_there() {
    return settled() && until([this] { return session().light_field().views() != nullptr; });
  }

 private slots:
  void flameIsSeenAsEyesSeeItAndExposed() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_2));
    QVERIFY(until([&] { return view().is_current(); }));
    const auto mean = [&](const QImage& picture) {
      double sum = 0;
      for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) sum += qGray(picture.pixel(x, y));
      return sum / (picture.width() * picture.height());
    };
    const QImage whole = view().picture();
    // Soot has no green or blue anywhere that its red does not exceed: no fringe, no olive. It
    // fills most of its view's height.
    int top = whole.height(), bottom = 0;
    for (int y = 0; y < whole.height(); ++y)
      for (int x = whole.width() / 4; x < whole.width() * 3 / 4; ++x) {
        const QColor c(whole.pixel(x, y));
        if (c.red() < 60 || c.red() - c.blue() < 30) continue;
        QVERIFY(c.red() >= c.green() && c.green() >= c.blue());
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
    QVERIFY2(bottom - top > 0.6 * whole.height(), qPrintable(QString::number(bottom - top)));
    auto* const exposure = child<QDoubleSpinBox>("flameExposure");
    QTest::mouseClick(child<QToolButton>("moreOfScene"), Qt::LeftButton);
    QVERIFY(exposure->isVisible());
    exposure->selectAll();
    QTest::keyClicks(exposure, "-3");
    QTest::keyClick(exposure, Qt::Key_Return);
    QCOMPARE(session().document().look().exposure, -3.0);
    QTest::keyClick(exposure->window(), Qt::Key_Escape);
    QVERIFY(!exposure->isVisible());
    QVERIFY(mean(view().picture()) < 0.7 * mean(whole));
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(exposure->value(), 0.0);
    QVERIFY(test::difference(whole, view().picture()) < 1e-3);
  }

  void init() { begin(); }
  void cleanup() { end(); }

  void longGapsAreDrawnShort() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_1));
    const auto share = [this] {  // distance from flame to lens, in heights of the flame
      const Box box = scene().medium->bounds();
      const Vec3 middle = flame_middle();
      const double height = apart(view().to_widget({middle.x, middle.y, box.lower.z}),
                                  view().to_widget({middle.x, middle.y, box.upper.z}));
      return apart(view().to_widget(middle), view().to_widget(world({0, 0, 0}))) / height;
    };
    const Box box = scene().medium->bounds();
    const double true_share = length(flame_middle()) / (box.upper.z - box.lower.z);
    QVERIFY(true_share > 10 && share() < 0.35 * true_share);
    // A clicked point is at its place in the world, not in the drawing.
    QTest::mouseClick(scene3d(), Qt::LeftButton, {}, seen_at(flame_middle()));
    QVERIFY(selection().kind == Selection::Kind::point);
    QVERIFY(length(selection().point - flame_middle()) < 0.6 * (box.upper.z - box.lower.z));
    const QPoint sensor = seen_at(pixel_in_world(150, 150));
    QTest::mouseClick(scene3d(), Qt::LeftButton, {}, sensor);
    QVERIFY(selection().kind == Selection::Kind::pixel);
    QVERIFY(apart(view().to_widget(pixel_in_world(selection().column, selection().row)), sensor) <
            1.5);
    // To scale it is as far as it is; the view is oblique, which shortens it a little.
    click("shortenGaps");
    QVERIFY2(share() > 0.6 * true_share, qPrintable(QString::number(share())));
    click("shortenGaps");
    QVERIFY(share() < 0.35 * true_share);
    // Lengths are measured to scale.
    click("measure");
    QVERIFY(view().schematic().is_to_scale());
    click("measure");
    QVERIFY(!view().schematic().is_to_scale());
  }

  void textsInTheSceneNeverMeet() {
    session().set_auto_render(false);  // nothing of it is about the image
    const QDir folder(PLENOFLAME_EXAMPLES);
    int drawn = 0, names = 0;
    for (const QString& name : folder.entryList({"*.toml"}, QDir::Files)) {
      QVERIFY2(window_->open(folder.filePath(name)),
               qPrintable(name + ": " + window_->last_message()));
      QVERIFY(written());
      const SceneCompiler& compiler = session().compiler();
      QVERIFY2(until([&] {
                 return !compiler.failure().isEmpty() ||
                        (compiler.is_current() && view().is_current());
               }),
               qPrintable(name));
      if (!compiler.failure().isEmpty()) continue;  // its flame is made by a command first
      for (const QSize size : {QSize(1366, 768), QSize(1600, 1000), QSize(1280, 720)}) {
        window_->resize(size);
        QVERIFY(until([&] { return window_->size() == size; }));
        for (const Qt::Key key : {Qt::Key_2, Qt::Key_1}) {
          press(key, Qt::ControlModifier);
          view().picture();
          const auto texts = written_in_3d();
          const QRectF whole(QPointF(0, 0), scene3d()->size());
          for (std::size_t i = 0; i < texts.size(); ++i) {
            const bool is_mark = texts[i].first == "break";
            if (!is_mark)
              QVERIFY2(whole.contains(texts[i].second), qPrintable(name + ": " + texts[i].first));
            for (std::size_t k = 0; k < i; ++k)
              if (!is_mark || texts[k].first != "break")
                QVERIFY2(!texts[i].second.intersects(texts[k].second),
                         qPrintable(QString("%1, %2 wide: %3 on %4")
                                        .arg(name)
                                        .arg(size.width())
                                        .arg(texts[i].first, texts[k].first)));
          }
          names += static_cast<int>(texts.size());
          ++drawn;
        }
      }
    }
    QVERIFY2(drawn > 60 && names > 2 * drawn, qPrintable(QString("%1 %2").arg(drawn).arg(names)));
  }

  void namesThatStandAwayAreLedToTheirCameras() {
    session().set_auto_render(false);
    int led = 0;
    for (const char* name : {"ring-of-six", "three-cameras"}) {
      QVERIFY(window_->open_example(name));
      QVERIFY(written());
      QVERIFY(until([&] { return session().compiler().is_current() && view().is_current(); }));
      press(Qt::Key_1, Qt::ControlModifier);
      for (const QSize size : {QSize(900, 560), QSize(1280, 720), QSize(1600, 1000)}) {
        window_->resize(size);
        QVERIFY(until([&] { return window_->size() == size; }));
        view().picture();
        const double height = scene3d()->height();
        std::map<QString, QPointF> seen;  // front vertices, upwards from the lower left corner
        const std::string chosen = scene().scene.camera.name;
        std::size_t other = 0;
        for (const CameraSpec& camera : session().document().scene().cameras) {
          const QPointF at = camera.name == chosen ? view().to_widget(camera.position)
                                                   : view().other_cameras_seen()[other++];
          seen[QString::fromStdString(camera.name)] = {at.x(), height - at.y()};
        }
        // All of them have the same lens: how far its rim is seen from its vertex.
        double diameter = 0, reach = 0;
        for (const SurfaceSpec& surface : scene().scene.camera.lens.surfaces)
          diameter = std::max(diameter, surface.diameter);
        for (int k = 0; k < 12; ++k) {
          const double angle = k * std::numbers::pi / 6, r = 0.5 * diameter;
          const Vec3 rim = world({r * std::cos(angle), r * std::sin(angle), 0});
          reach = std::max(reach, apart(view().to_widget(rim), view().to_widget(world({}))));
        }
        const std::vector<QLineF> lines = leaders();
        for (const auto& [text, box] : written_in_3d()) {
          const auto of = seen.find(text);
          if (of == seen.end()) continue;
          // Either the name stands beside its lens, or a line leads from it to there: from the
          // vertex it is as far as to the rim, a corner at most, and from there less than a line;
          // for large lenses, too, no farther than three lines from the rim.
          const double line = box.height();
          const double away = std::hypot(
              std::max({box.left() - of->second.x(), of->second.x() - box.right(), 0.0}),
              std::max({box.top() - of->second.y(), of->second.y() - box.bottom(), 0.0}));
          bool is_led = false;
          for (const QLineF& leader : lines)
            is_led |= box.adjusted(-3, -3, 3, 3).contains(leader.p1()) &&
                      apart(leader.p2(), of->second) < away;
          led += is_led ? 1 : 0;
          QVERIFY2(is_led || away < std::min(std::numbers::sqrt2 * reach + line, reach + 3 * line),
                   qPrintable(QString("%1, %2 wide: %3 is %4 away")
                                  .arg(name)
                                  .arg(size.width())
                                  .arg(text)
                                  .arg(away)));
        }
      }
    }
    QVERIFY(led > 0);
  }

  void flameAndCameraAreDragged() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_1));
    QVERIFY(view().handles().empty());
    click("moveThings");
    QCOMPARE(view().handles().size(), std::size_t{2});
    const Vec3 before = session().document().scene().flames[0].position;
    const QPointF from = view().to_widget(view().handles()[0]), by(14, -30);
    QVERIFY(apart(from, view().to_widget(flame_middle())) < 1);
    hover(scene3d(), from);
    drag(scene3d(), from, from + by);
    QVERIFY(settled());
    const Vec3 after = session().document().scene().flames[0].position;
    QVERIFY(after.z > before.z);
    // It is seen where it was dropped.
    QVERIFY2(apart(view().to_widget(flame_middle()), from + by) < 3,
             qPrintable(QString::number(apart(view().to_widget(flame_middle()), from + by))));
    QVERIFY(selection().kind == Selection::Kind::none);
    press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(session().document().scene().flames[0].position == before);
    QVERIFY(!session().document().can_undo());
    QVERIFY(settled());
    const Vec3 camera = session().document().scene().camera.position;
    const QPointF lens = view().to_widget(view().handles()[1]);
    hover(scene3d(), lens);
    drag(scene3d(), lens, lens + QPointF(0, 20));
    QVERIFY(settled());
    QVERIFY(session().document().scene().camera.position.z < camera.z);
    press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(session().document().scene().camera.position == camera);
    click("moveThings");
    QVERIFY(view().handles().empty());
  }

  void lightRunsAlongTheRays() {
    QVERIFY(open_example("lenslets-30"));
    session().document().select(Selection::of_pixel(150, 150));
    QVERIFY(until([this] { return session().rays().rays() && session().rays().is_current(); }));
    QVERIFY(settled());
    const QImage still = view().picture();
    click("runLight");
    QVERIFY(until([&] { return test::difference(still, view().picture()) > 1e-5; }));
    const QImage first = view().picture();
    QVERIFY(until([&] { return test::difference(first, view().picture()) > 1e-5; }));
    click("runLight");
    QVERIFY(until([&] { return test::difference(still, view().picture()) == 0; }));
  }

  void viewsOfOneTypeOfMicrolenses() {
    QVERIFY(open_example("lenslets-30"));
    show_tab(LightFieldPanel::Tab::views);
    QVERIFY(views_there());
    auto* const type = child<QComboBox>("viewType");
    QVERIFY(type->isVisible());
    QCOMPARE(type->count(), 4);
    const int all = session().light_field().views()->views[0].image.width;
    type->setFocus();
    QTest::keyClick(type, Qt::Key_Down);
    // A third of the lenses: steps longer by the root of 3.
    QVERIFY(until([&] { return session().light_field().views()->views[0].image.width < all; }));
    const int one = session().light_field().views()->views[0].image.width;
    QVERIFY2(std::abs(one * std::sqrt(3.0) / all - 1) < 0.15,
             qPrintable(QString("%1 of %2").arg(one).arg(all)));
    // All pictures have the colours of the image.
    auto* const map = child<QComboBox>("map");
    auto* const shown = child<ImageView>("subApertureView");
    QVERIFY(shown->tone_settings().map == window_->image_panel().map());
    map->setFocus();
    QTest::keyClick(map, Qt::Key_Up);
    QVERIFY(window_->image_panel().map() == ColourMap::cividis);
    QVERIFY(shown->tone_settings().map == ColourMap::cividis);
  }

  void refocusedThroughGlassAsTheCommandDoes() {
    const std::string plate =
        "\n[[windows]]\nshape = \"plate\"\nposition = [\"0.5 m\", \"0 m\", \"0 m\"]\n"
        "rotation = [\"0 deg\", \"90 deg\", \"0 deg\"]\ndiameter = \"300 mm\"\n"
        "thickness = \"100 mm\"\nindex = 1.5\n";
    write(file("glass.toml"), (test::small_scene_text() + plate).c_str());
    run(PLENOFLAME_COMMAND, {"render", file("glass.toml"), "-o", file("raw.exr")});
    QVERIFY(window_->open(file("raw.exr")));
    QVERIFY(written() && settled());
    show_tab(LightFieldPanel::Tab::views);
    QVERIFY(views_there());
    show_tab(LightFieldPanel::Tab::refocus);
    auto* edit = child<QLineEdit>("depthEdit");
    edit->selectAll();
    QTest::keyClicks(edit, "1.05 m");
    QTest::keyClick(edit, Qt::Key_Return);
    const DerivedImage& r = session().light_field().refocused();
    QVERIFY(until([&] { return r.image && !r.preview; }));
    run(PLENOFLAME_COMMAND,
        {"refocus", file("raw.exr"), "--depth", QString::number(r.depth, 'g', 17) + " m", "--exr",
         "-o", file("refocus")});
    bool found = false;
    const QDir folder(file("refocus"));
    for (const QString& name : folder.entryList({"*.exr"}, QDir::Files))
      found |= read_light_field(folder.filePath(name).toStdString()).channels[0].flux.pixels ==
               r.image->pixels;
    QVERIFY2(found, qPrintable(folder.entryList().join(' ')));
  }

  void histogramStandsBehindTheCurve() {
    QVERIFY(open_example("lenslets-30"));
    raise("flameGroup");
    auto* const curve = child<OpacityCurve>("flameOpacity");
    double hottest = 0;
    for (const EllipsoidSpec& layer : session().document().scene().flames[0].layers)
      hottest = std::max(hottest, layer.temperature);
    // Layers have one temperature each, and nothing lies between them.
    QVERIFY(until([&] { return curve->height_at(hottest) > 0; }));
    for (const EllipsoidSpec& layer : session().document().scene().flames[0].layers)
      QVERIFY2(curve->height_at(layer.temperature) > 0,
               qPrintable(QString::number(layer.temperature)));
    QCOMPARE(curve->height_at(0.5 * hottest), 0.0);
    QCOMPARE(curve->height_at(hottest + 50), 0.0);
  }

  void filmIsPutTogetherByAnEncoder() {
    const QByteArray path = encoder_in_place_of_ffmpeg();
    write(file("small.toml"), test::small_scene_text().c_str());
    QVERIFY(window_->open(file("small.toml")));
    QVERIFY(settled());
    window_->scene_panel().reveal("flames[0].brightness");
    QVERIFY(click_menu({"Render", "Film of a parameter..."}));
    auto* const film = child<FilmDialog>("filmDialog");
    auto* const to = child<QLineEdit>("filmTo");
    to->setFocus();
    to->selectAll();
    QTest::keyClicks(to, "0.5");
    film->record(file("film.mp4"));
    QVERIFY(until([&] { return !film->is_recording(); }));
    qputenv("PATH", path);
    QVERIFY2(QFile::exists(file("film.mp4")), qPrintable(film->message()));
    QFile called(file("called"));
    QVERIFY(called.open(QIODevice::ReadOnly));
    QVERIFY(called.readAll().contains(".png"));
    film->close();
  }

  void filmShowsFinishedPicturesAndStops() {
    QVERIFY(open_example("lenslets-30"));
    window_->scene_panel().reveal("flames[0].scale");
    QVERIFY(click_menu({"Render", "Film of a parameter..."}));
    auto* const film = child<FilmDialog>("filmDialog");
    auto* const to = child<QLineEdit>("filmTo");
    child<QLineEdit>("filmFrom")->setText("1");
    const auto film_of = [&](const char* what, const char* name, int frames) {
      auto* const of = child<QComboBox>("filmView");
      of->setCurrentText(what);
      to->setFocus();
      to->selectAll();
      QTest::keyClicks(to, "0.5");
      child<QSpinBox>("filmFrames")->setValue(frames);
      answer_file_dialog(file(name));
      QTest::mouseClick(child<QPushButton>("filmRecord"), Qt::LeftButton);
    };
    // One scale of brightness, in the films and after them.
    auto* const white = child<QLineEdit>("white");
    QTest::keyClicks(white, "5 nW");
    QTest::keyClick(white, Qt::Key_Return);
    const QPointF lens = view().to_widget(world({}));
    film_of("the picture", "picture.png", 2);
    QVERIFY(until([&] { return !film->is_recording(); }));
    QVERIFY(settled());
    QVERIFY(apart(view().to_widget(world({})), lens) < 1);
    film_of("the 3-D view", "space.png", 2);
    QVERIFY(until([&] { return !film->is_recording(); }));
    const double changed =
        test::difference(QImage(file("space.0001.png")), QImage(file("space.0002.png")));
    QVERIFY2(changed > 1e-3, qPrintable(QString::number(changed)));
    QVERIFY(settled());
    // In the midst: no file is left, and the scene is as it was.
    const QByteArray path = encoder_in_place_of_ffmpeg();
    film_of("the picture", "stopped.mp4", 50);
    auto* const bar = film->findChild<QProgressBar*>();
    QVERIFY(until([&] { return bar->value() >= 2 || !film->is_recording(); }));
    QTest::mouseClick(child<QPushButton>("filmStop"), Qt::LeftButton);
    QVERIFY(!film->is_recording());
    QVERIFY2(film->message().contains("stopped"), qPrintable(film->message()));
    QVERIFY(!QFile::exists(file("stopped.mp4")));
    qputenv("PATH", path);
    QCOMPARE(session().document().scene().flames[0].scale, 1.0);
    film->close();
    QVERIFY(settled());
    // The last picture of the film is what the scene with its value looks like, finished.
    const QImage last(file("picture.0002.png"));
    type("flames[0].scale", "0.5");
    QVERIFY(settled());
    const QImage finished = image().drawn();
    QVERIFY(test::difference(last.copy(finished.rect()), finished) < 1e-3);
    QVERIFY(test::difference(QImage(file("picture.0001.png")), last) > 1e-2);
  }

  void filmsByFfmpegHaveAllPictures() {
    write(file("small.toml"), test::small_scene_text().c_str());
    QVERIFY(window_->open(file("small.toml")));
    QVERIFY(settled());
    window_->scene_panel().reveal("flames[0].scale");
    QVERIFY(click_menu({"Render", "Film of a parameter..."}));
    auto* const film = child<FilmDialog>("filmDialog");
    auto* const to = child<QLineEdit>("filmTo");
    to->setFocus();
    to->selectAll();
    QTest::keyClicks(to, "0.4");
    child<QLineEdit>("filmFrom")->setText("1");
    child<QSpinBox>("filmFrames")->setValue(5);
    const bool there = !QStandardPaths::findExecutable("ffmpeg").isEmpty();
    for (const QString& name : {QString("film.mp4"), QString("film.gif")}) {
      if (there) {
        answer_file_dialog(file(name));
        QTest::mouseClick(child<QPushButton>("filmRecord"), Qt::LeftButton);
      } else {
        film->record(file(name));  // the dialog offers pictures alone then
      }
      QVERIFY(until([&] { return !film->is_recording(); }));
      if (!there) {
        QVERIFY2(film->message().contains("ffmpeg is not installed"), qPrintable(film->message()));
        QVERIFY(!QFile::exists(file(name)));
        continue;
      }
      QVERIFY2(QFile::exists(file(name)), qPrintable(film->message()));
      // Its own reader counts the pictures.
      const QString said = run(
          "ffprobe", {"-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries",
                      "stream=nb_read_frames,width,height,duration", "-of", "csv=p=0", file(name)});
      const QStringList figures = said.trimmed().split(',');  // width, height, duration, frames
      QVERIFY2(figures.size() == 4 && figures[3] == "5", qPrintable(name + ": " + said));
      // As large as the picture in the window; sides of .mp4 are even.
      QSize shown = image().drawn().size();
      shown.rheight() += 2 * std::max(12, static_cast<int>(std::lround(0.03 * shown.height())));
      const auto even = [&](int side) { return name.endsWith("mp4") ? side + side % 2 : side; };
      QCOMPARE(QSize(figures[0].toInt(), figures[1].toInt()),
               QSize(even(shown.width()), even(shown.height())));
      // Twelve pictures in a second; .gif counts hundredths.
      QVERIFY2(std::abs(figures[2].toDouble() / (5 / 12.0) - 1) < 0.05, qPrintable(said));
      // The flame shrinks, and with it the light.
      run("ffmpeg", {"-y", "-loglevel", "error", "-i", file(name), file("frame%d.png")});
      const auto light = [&](int frame) {
        const QImage picture(file(QString("frame%1.png").arg(frame)));
        double sum = 0;
        for (int y = 0; y < picture.height(); ++y)
          for (int x = 0; x < picture.width(); ++x) sum += qGray(picture.pixel(x, y));
        return sum;
      };
      QVERIFY2(light(1) > 1.05 * light(5) && light(5) > 0,
               qPrintable(QString("%1: %2 %3").arg(name).arg(light(1)).arg(light(5))));
    }
    film->close();
  }

 private:
  // In the place of ffmpeg: keeps what it was called with, and makes a file.
  // @return the search path as it was before
  QByteArray encoder_in_place_of_ffmpeg() {
    write(file("ffmpeg"),
          "#!/bin/sh\necho \"$@\" > \"$(dirname \"$0\")/called\"\n"
          "for last; do :; done\necho film > \"$last\"\n");
    QFile::setPermissions(file("ffmpeg"), QFile::ReadOwner | QFile::WriteOwner | QFile::ExeOwner);
    const QByteArray path = qgetenv("PATH");
    qputenv("PATH", folder_->path().toUtf8() + ":" + path);
    return path;
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_drawing_test() {
  return std::make_unique<DrawingTest>();
}

#include "drawing_test.moc"

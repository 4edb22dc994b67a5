// Values by their components, lists and greyed keys, help, recovery, keys: what makes the window
// easy to handle. References: the scene's own values, descriptions of the keys, where things stand.
#include <QComboBox>
#include <QDir>
#include <QLabel>
#include <QMessageBox>
#include <QPushButton>
#include <QScreen>
#include <QSlider>
#include <QTextBrowser>
#include <QTreeView>
#include <cmath>

#include "gui_tests.h"
#include "plenoflame/scene/scene_file.h"
#include "scene_fixture.h"
#include "scenes.h"
#include "widgets/panels/scene_panel.h"
#include "widgets/window/help_window.h"

using namespace plenoflame;
using namespace plenoflame::desktop;
using plenoflame::desktop::test::difference;

class HandlingTest : public test::SceneFixture {
  Q_OBJECT

  ParameterModel& model() { return window_->scene_panel().model(); }
  Vec3 position() { return session().document().scene().flames.at(0).position; }
  QString name_of(const char* path) { return model().find(path).data().toString(); }
  bool is_greyed(const char* path) {
    return !model().find(path).data(ParameterModel::kReasonRole).toString().isEmpty();
  }
  bool flame_is_seen() {
    const Box box = scene().medium->bounds();
    return scene3d()->rect().contains(seen_at(0.5 * (box.lower + box.upper)));
  }
  void place_flame(const char* text) {
    const auto before = session().compiler().compiled();
    type("flames[0].position", text);
    QVERIFY(until([&] {
      return session().compiler().compiled() != before && session().compiler().is_current() &&
             view().is_current();
    }));
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void viewsFollowTheFlame() {
    QVERIFY(open_example("lenslets-30"));
    for (const Qt::Key key : {Qt::Key_2, Qt::Key_1}) {
      QVERIFY(part(key));
      QVERIFY(flame_is_seen());
      place_flame("1.6 m, 0.3 m, 0.2 m");
      QVERIFY(flame_is_seen());
      place_flame("1 m, 0 m, -29 mm");
      QVERIFY(flame_is_seen());
    }
    // The flame's middle, 1.6 m before the camera, is in the section, too.
    place_flame("1.6 m, 0 m, 0 m");
    QVERIFY(section().rect().contains(section().to_widget(1.6, 0).toPoint()));
    // Somebody who turned the view keeps his direction while the flame stays in sight.
    QVERIFY(part(Qt::Key_2));
    const QPointF middle = scene3d()->rect().center();
    drag(scene3d(), middle, middle + QPointF(60, 10));
    const double height = view().view_height();
    place_flame("1.7 m, 0.1 m, 0 m");
    QVERIFY(flame_is_seen());
    QVERIFY(std::fabs(view().view_height() / height - 1) < 1e-6);
  }

  // As it stands on the screen: a picture that the view makes of itself would draw it anew.
  void flameIsWholeAfterWalksThroughTheParts() {
    window_->resize(1366, 768);
    QVERIFY(open_example("lenslets-30"));
    const auto click = [this](const char* name) {
      for (auto* button : window_->findChildren<QToolButton*>())
        if (button->defaultAction() == child<QAction>(name))
          QTest::mouseClick(button, Qt::LeftButton);
      QVERIFY(settled());
      QTest::qWait(300);
    };
    const auto seen = [this] {
      const QWidget* const space = child<QWidget>("scene3d");
      const QPoint corner = space->mapToGlobal(QPoint(0, 0));
      return QGuiApplication::primaryScreen()
          ->grabWindow(0, corner.x(), corner.y(), space->width(), space->height())
          .toImage();
    };
    auto* const drawing = child<QComboBox>("flameDrawing");
    for (int way = 0; way < 3; ++way) {
      click("viewFlame");
      const QImage near = seen();
      click("viewScene");
      const QImage whole = seen();
      QVERIFY(test::difference(near, whole) > 0.01);
      click("viewFlame");
      QVERIFY2(test::difference(near, seen()) < 1e-3, qPrintable(QString::number(way)));
      click("viewScene");
      QVERIFY2(test::difference(whole, seen()) < 1e-3, qPrintable(QString::number(way)));
      // The same as a picture that is drawn anew.
      QImage anew = view().picture();
      QVERIFY2(test::difference(whole, anew.convertToFormat(whole.format())) < 5e-3,
               qPrintable(QString("%1 %2").arg(way).arg(test::difference(whole, anew))));
      QTest::keyClick(drawing, Qt::Key_Down);
    }
  }

  void vectorsAreEditedByTheirComponents() {
    QVERIFY(open_example("lenslets-30"));
    const Vec3 before = position();
    QCOMPARE(name_of("flames[0].position.x"), QString("X"));
    QCOMPARE(name_of("flames[0].position.z"), QString("Z"));
    type("flames[0].position.x", "1.25 m");
    QCOMPARE(position().x, 1.25);
    QCOMPARE(position().y, before.y);
    QCOMPARE(position().z, before.z);
    const QModelIndex whole = model().find("flames[0].position", ParameterModel::kValue);
    QVERIFY2(whole.data().toString().startsWith("1.25 m, "), qPrintable(whole.data().toString()));
    // A slider moves it, also from 0; one stroke is one step.
    window_->scene_panel().reveal("flames[0].position.y");
    auto* slider = child<QSlider>("parameterSlider");
    QVERIFY(slider->isEnabled());
    QTest::keyClick(slider, Qt::Key_PageUp);
    QTest::keyClick(slider, Qt::Key_PageUp);
    QVERIFY(position().y > 0);
    QCOMPARE(position().x, 1.25);
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(position().y, before.y);
    QCOMPARE(position().x, 1.25);
    // A refused text stays at its place.
    type("flames[0].position.z", "3 kg");
    QCOMPARE(model().find("flames[0].position.z", ParameterModel::kValue).data().toString(),
             QString("3 kg"));
    QVERIFY(model().find("flames[0].position.z").data(ParameterModel::kIsErrorRole).toBool());
    QCOMPARE(position().z, before.z);
  }

  // The f-number is not kept in a scene, but in its stop. Reference: the file that sets it.
  void fNumberStandsInTheTree() {
    const auto with = [](const char* number) {
      return QByteArray(test::small_scene_text().c_str()) +
             "\n[camera.lens]\nf_number = " + number + "\n";
    };
    write(file("eight.toml"), with("8"));
    write(file("five.toml"), with("5.6"));
    const auto stop = [](const Scene& scene) {
      for (const SurfaceSpec& surface : scene.camera.lens.surfaces)
        if (surface.stop) return surface.diameter;
      return 0.0;
    };
    const double wide = stop(read_scene_file(file("five.toml").toStdString()).scene);
    QVERIFY(window_->open(file("eight.toml")));
    QVERIFY(settled());
    const auto shown = [this] {
      return model().find("camera.lens.f_number", ParameterModel::kValue).data().toString();
    };
    QCOMPARE(shown(), QString("8"));
    const double narrow = stop(session().document().scene());
    type("camera.lens.f_number", "5.6");  // wider than in the file, but not than the glass
    QVERIFY2(std::fabs(stop(session().document().scene()) / wide - 1) < 1e-12,
             qPrintable(QString::number(stop(session().document().scene()))));
    QVERIFY(wide > 1.3 * narrow);
    QCOMPARE(shown(), QString("5.6"));
    QVERIFY(model().find("camera.lens.f_number").data(ParameterModel::kMessageRole).isNull() ||
            model().find("camera.lens.f_number").data(ParameterModel::kMessageRole) == QString());
    for (const char* wrong : {"0", "-4", "4 mm", "wide"}) {
      type("camera.lens.f_number", wrong);
      QVERIFY2(model().find("camera.lens.f_number").data(ParameterModel::kIsErrorRole).toBool(),
               wrong);
      press(Qt::Key_Z, Qt::ControlModifier);
      QCOMPARE(shown(), QString("5.6"));
    }
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(stop(session().document().scene()), narrow);
    QCOMPARE(shown(), QString("8"));
    // It follows the stop, and the slider moves both.
    auto* const slider = child<QSlider>("parameterSlider");
    window_->scene_panel().reveal("camera.lens.f_number");
    QVERIFY(slider->isEnabled());
    QTest::keyClick(slider, Qt::Key_PageUp);
    QVERIFY(stop(session().document().scene()) < narrow);
    QVERIFY2(shown().toDouble() > 8, qPrintable(shown()));
    QVERIFY(settled());
  }

  void stopThatIsWiderThanItsLensIsSaid() {
    QVERIFY(open_example("lenslets-30"));
    const auto& surfaces = session().document().scene().camera.lens.surfaces;
    std::size_t stop = 0;
    double widest = 0;
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      if (surfaces[i].stop)
        stop = i;
      else
        widest = std::max(widest, surfaces[i].diameter);
    const QString path = QString("camera.lens.surfaces[%1].diameter").arg(stop);
    const auto* const message = child<QLabel>("sceneMessage");
    QVERIFY(!message->isVisible());
    type(qPrintable(path), "500 mm");
    QVERIFY(message->isVisible());
    QCOMPARE(message->text(),
             QString("the stop of the main lens is 500 mm wide and its widest surface %1 mm: the "
                     "surfaces limit the light, and the f-number, which is computed from the stop, "
                     "is too small; make the stop smaller")
                 .arg(1000 * widest));
    // It stands at its line, as a warning.
    const QModelIndex line = model().find(path.toStdString());
    QCOMPARE(line.data(ParameterModel::kMessageRole).toString(), message->text());
    QVERIFY(!line.data(ParameterModel::kIsErrorRole).toBool());
    press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(!message->isVisible());
  }

  void conjugateHasItsList() {
    QVERIFY(open_example("lenslets-30"));
    ScenePanel& panel = window_->scene_panel();
    panel.reveal("camera.focus.conjugate");
    QTest::keyClick(&panel.tree(), Qt::Key_F2);
    auto* box = panel.tree().findChild<QComboBox*>();
    QVERIFY(box);
    QStringList names;
    for (int i = 0; i < box->count(); ++i) names << box->itemText(i);
    QCOMPARE(names, (QStringList{"array", "type1", "type2", "type3"}));
    QCOMPARE(box->currentText(), QString("type2"));
  }

  void keysWithoutEffectAreGreyed() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(is_greyed("flames[0].file") && is_greyed("flames[0].temperature.grid"));
    QVERIFY(!is_greyed("flames[0].layers[0].temperature") && !is_greyed("flames[0].kind"));
    QVERIFY(is_greyed("camera.focus.lens_distance"));
    QVERIFY(!is_greyed("camera.focus.object_distance"));
    QVERIFY(is_greyed("camera.lens.focal_length") && is_greyed("channels[0].response"));
    QVERIFY(!is_greyed("channels[0].wavelength"));
    session().document().set_value("camera.focus.mode", "distance");
    QVERIFY(!is_greyed("camera.focus.lens_distance"));
    QVERIFY(is_greyed("camera.focus.object_distance"));
    // They are drawn in the colour of what is disabled.
    ScenePanel& panel = window_->scene_panel();
    const auto darkest = [&](const char* path) {
      panel.reveal(path);
      panel.tree().clearSelection();
      panel.tree().setCurrentIndex({});
      const QRect place = panel.tree().visualRect(model().find(path));
      const QImage drawn = panel.tree().viewport()->grab(place).toImage();
      int least = 255;
      for (int y = 0; y < drawn.height(); ++y)
        for (int x = 0; x < drawn.width(); ++x)
          least = std::min(least, QColor(drawn.pixel(x, y)).lightness());
      return least;
    };
    QVERIFY(darkest("camera.focus.object_distance") > darkest("camera.focus.mode") + 40);
  }

  void surfacesOfTheLensHaveNames() {
    QVERIFY(open_example("lenslets-30"));  // a singlet with the stop behind it
    QCOMPARE(name_of("camera.lens.surfaces[0]"), QString("1: front of lens 1"));
    QCOMPARE(name_of("camera.lens.surfaces[1]"), QString("2: back of lens 1"));
    QCOMPARE(name_of("camera.lens.surfaces[2]"), QString("3: stop"));
    session().document().apply_preset(PresetKind::lens, "achromat-100mm");
    QCOMPARE(name_of("camera.lens.surfaces[1]").section(", ", 0, 0),
             QString("2: between lens 1 and 2"));
  }

  void helpOpensInsideTheApplication() {
    QVERIFY(open_example("lenslets-30"));
    raise("raysGroup");
    child<QWidget>("raysTable")->setFocus();
    press(Qt::Key_F1);
    auto* help = window_->findChild<HelpWindow*>();
    QVERIFY(help && help->isVisible());
    QCOMPARE(help->page(), QString("rays.md"));
    auto* browser = help->findChild<QTextBrowser*>("helpBrowser");
    QVERIFY(browser->toPlainText().size() > 1000);
    QVERIFY(!browser->toPlainText().contains("<!--"));
    image().setFocus();
    press(Qt::Key_F1);
    QCOMPARE(help->page(), QString("desktop.md"));
    QTest::mouseClick(help->findChild<QPushButton*>("helpBack"), Qt::LeftButton);
    QCOMPARE(help->page(), QString("rays.md"));
    QApplication::setActiveWindow(help);
    QTest::keyClick(help, Qt::Key_Escape);
    QVERIFY(!help->isVisible());
  }

  void recoveryIsOfferedBesideAFile() {
    QVERIFY(open_example("lenslets-30"));
    const QString given = file("given.toml");
    session().document().save(given.toStdString());
    type("camera.focus.object_distance", "1.5 m");
    // A copy of what was not saved, left behind by a program that is gone.
    const QString folder = folder_->filePath("recovery"), kept = folder_->filePath("kept");
    QVERIFY(until([&] { return !QDir(folder).entryList({"*.toml"}).isEmpty(); }));
    QVERIFY(QDir().mkpath(kept));
    for (const QString& name : QDir(folder).entryList(QDir::Files)) {
      QString dead = name;
      dead.replace(QString::number(QCoreApplication::applicationPid()), "999999999");
      QVERIFY(QFile::copy(folder + "/" + name, kept + "/" + dead));
    }
    for (const bool wanted : {false, true}) {
      if (wanted)
        for (const QString& name : QDir(folder).entryList(QDir::Files)) {
          QString dead = name;
          dead.replace(QString::number(QCoreApplication::applicationPid()), "999999999");
          QFile::copy(folder + "/" + name, kept + "/" + dead);
        }
      MainWindow other(std::make_unique<QSettings>(file("other.ini"), QSettings::IniFormat),
                       kept.toStdString());
      other.resize(1400, 900);
      other.show();
      bool asked = false;
      when_shown<QMessageBox>([&](QMessageBox& box) {
        asked = true;
        QTest::mouseClick(box.button(wanted ? QMessageBox::Yes : QMessageBox::No), Qt::LeftButton);
      });
      QVERIFY(other.begin(given));
      QVERIFY(asked);
      QCOMPARE(other.session().document().scene().camera.focus.object_distance, wanted ? 1.5 : 1.0);
      other.set_unattended(true);
    }
  }

  void welcomePageIsUsedByKeys() {
    auto* example = child<QPushButton>("example-lenslets-30");
    const QImage before = example->grab().toImage();
    child<QPushButton>("welcomeOpen")->setFocus();
    for (int i = 0; i < 40 && !example->hasFocus(); ++i)
      QTest::keyClick(QApplication::focusWidget(), Qt::Key_Tab);
    QVERIFY(example->hasFocus());
    QVERIFY(difference(before, example->grab().toImage()) > 0.01);
    QTest::keyClick(example, Qt::Key_Return);
    QVERIFY(settled());
    QVERIFY(image().isVisible());
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_handling_test() {
  return std::make_unique<HandlingTest>();
}

#include "handling_test.moc"

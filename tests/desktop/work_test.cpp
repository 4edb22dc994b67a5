// Work in the background, messages about it, and its failures. References: the
// messages and figures of the command.
#include <unistd.h>

#include <QAbstractButton>
#include <QComboBox>
#include <QDir>
#include <QFile>
#include <QLabel>
#include <QMessageBox>
#include <QStatusBar>
#include <QTableWidget>
#include <QTreeView>
#include <csignal>
#include <cstdlib>

#include "gui_tests.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/volumes/grid_writer.h"
#include "scene_fixture.h"
#include "widgets/flame/flame_dialogs.h"
#include "widgets/panels/scene_panel.h"

using namespace plenoflame;
using namespace plenoflame::desktop;
using plenoflame::desktop::test::difference;

class WorkTest : public test::SceneFixture {
  Q_OBJECT

  /// The command's line on standard error; it must fail.
  QString refusal(const QStringList& arguments) {
    QProcess process;
    process.start(PLENOFLAME_COMMAND, arguments);
    if (!process.waitForFinished(test::kPatience) || process.exitCode() == 0)
      test::complain("was not refused: " + arguments.join(' '));
    return QString::fromUtf8(process.readAllStandardError());
  }
  /// Two boxes of voxels, one hot and one sooty; nothing says in which units.
  QString flame_without_units() {
    VoxelField field;
    field.brick_origins = {{0, 0, 0}, {0, 0, 8}};
    field.index_to_world.linear.rows = {{{2e-3, 0, 0}, {0, 2e-3, 0}, {0, 0, 2e-3}}};
    VoxelField hot = field, sooty = field;
    hot.name = "temperature";
    hot.values.assign(1024, 1600);
    sooty.name = "absorption";
    sooty.values.assign(1024, 12);
    const std::array<GridOutput, 2> grids{{{&hot, ""}, {&sooty, ""}}};
    write_grids(file("box.vdb").toStdString(), grids);
    return file("box.vdb");
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void geometryChangesAtOnceAndTheImageLater() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_2));  // the flame fills the view
    session().document().set_value("render.samples", "20000");
    QVERIFY(until([&] { return session().compiler().is_current() && view().is_current(); }));
    const QImage before = view().picture();
    const auto image_before = session().document().image();
    const auto compiled = session().compiler().compiled();
    type("flames[0].scale", "0.5");
    QVERIFY(until([&] {
      return session().compiler().compiled() != compiled && session().compiler().is_current() &&
             view().is_current();
    }));
    QVERIFY(difference(before, view().picture()) > 1e-3);
    RenderJob& job = session().render();
    QVERIFY(job.state() == RenderJob::State::running);
    // Coarse first; finer pictures follow while it runs, and figures.
    QVERIFY(until([&] { return session().document().image() != image_before; }));
    const auto first = session().document().image();
    QVERIFY(until([&] { return session().document().image() != first; }));
    QVERIFY(job.state() == RenderJob::State::running);
    QVERIFY(child<QToolButton>("statusLine")->text().contains("rendering"));
    auto* rays = child<QLabel>("renderRays");
    auto* time = child<QLabel>("renderTime");
    QVERIFY(until([&] { return rays->text().contains("million per second"); }));
    QVERIFY(until([&] { return time->text().contains("to go"); }));
    QVERIFY(until([&] { return child<QLabel>("renderError")->text().contains('%'); }));
    // Undone and done again by keys.
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(session().document().scene().flames[0].scale, 1.0);
    press(Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
    QCOMPARE(session().document().scene().flames[0].scale, 0.5);
    QTest::mouseClick(child<QWidget>("renderStop"), Qt::LeftButton);
  }

  void whatIsDeferredSaysSo() {
    QVERIFY(open_example("lenslets-30"));
    auto* busy = child<QToolButton>("statusLine");
    QVERIFY(until([&] { return busy->text().startsWith("error"); }));
    // A click opens the curve of the error.
    QVERIFY(!child<QWidget>("renderCurve")->isVisible());
    QTest::mouseClick(busy, Qt::LeftButton);
    QVERIFY(child<QWidget>("renderCurve")->isVisible());
    QTest::mouseClick(child<QAbstractButton>("renderAutomatic"), Qt::LeftButton, {}, QPoint(8, 8));
    type("camera.focus.object_distance", "1.2 m");
    QVERIFY2(until([&] { return busy->text().contains("F5"); }), qPrintable(busy->text()));
    press(Qt::Key_F5);
    QVERIFY(settled());
    QVERIFY(until([&] { return busy->text().startsWith("error"); }));
  }

  void warningsOfTheDesignAreTheCommands() {
    QVERIFY(window_->open_example("paper-previous-60x60"));
    raise("designGroup");
    QVERIFY(until(
        [&] { return session().design().result() && session().design().result()->complete; }));
    auto* warnings = child<QLabel>("designWarnings");
    QVERIFY(warnings->isVisible());
    session().document().save(file("scene.toml").toStdString());
    QProcess command;
    command.start(PLENOFLAME_COMMAND, {"design", file("scene.toml")});
    QVERIFY(command.waitForFinished(test::kPatience));
    const QString said = (command.readAllStandardOutput() + command.readAllStandardError());
    for (const QString& line : warnings->text().split('\n'))
      QVERIFY2(said.simplified().contains(line.simplified()), qPrintable(line + "\n" + said));
    QVERIFY(warnings->text().contains("number"));
  }

  void dialogOfTheGridsSaysWhatIsDoubtful() {
    const QString flame = flame_without_units();
    answer_file_dialog(flame);
    press(Qt::Key_O, Qt::ControlModifier);
    QVERIFY(until([&] { return !session().document().is_empty(); }));
    QVERIFY(settled());
    raise("flameGroup");
    const QString command = run(PLENOFLAME_COMMAND, {"info", flame}).simplified();
    QString warning, guess;
    when_shown<MappingDialog>([&](MappingDialog& dialog) {
      auto* label = dialog.findChild<QLabel*>("mappingWarning");
      if (label->isVisible()) warning = label->text();
      guess = dialog.findChild<QComboBox*>("TemperatureGrid")->currentText();
      QTest::keyClick(&dialog, Qt::Key_Escape);
    });
    QTest::mouseClick(child<QPushButton>("flameMapping"), Qt::LeftButton);
    QVERIFY(written());
    QCOMPARE(guess, QString("guess: temperature"));
    QVERIFY(warning.contains("no unit"));
    for (const QString& line : warning.split('\n'))
      QVERIFY2(command.contains(line.simplified()), qPrintable(line + "\n" + command));
  }

  void whatCannotBeOpenedIsSaidAsTheCommandSaysIt() {
    QVERIFY(open_example("lenslets-30"));
    const Scene before = session().document().scene();
    const auto image_before = session().document().image();
    window_->set_unattended(false);
    write(file("bad.toml"), "[camera]\npreset = \"paper\"\n");
    write(file("bad.vdb"), QByteArray("\x20\x42\x44\x56\0\0\0\0", 8) + "no grids in here");
    write(file("bad.exr"), QByteArray("\x76\x2f\x31\x01") + "no picture in here");
    for (const char* name : {"bad.toml", "bad.vdb", "bad.exr"}) {
      QString text;
      // The file dialog first, then the message.
      when_shown<QFileDialog>([&](QFileDialog& dialog) {
        when_shown<QMessageBox>([&](QMessageBox& box) {
          text = box.text();
          QTest::keyClick(&box, Qt::Key_Return);
        });
        test::type_file_name(dialog, file(name));
      });
      press(Qt::Key_O, Qt::ControlModifier);
      QVERIFY2(until([&] { return !text.isEmpty(); }), name);
      const QString command = refusal({"info", file(name)});
      QVERIFY2(command.contains(text), qPrintable(text + "\n" + command));
      QVERIFY(session().document().scene() == before);
      QVERIFY(session().document().image() == image_before);
      QVERIFY(!window_->isWindowModified());
    }
    window_->set_unattended(true);
  }

  void failureOfAWorkerIsSaidAndTheWindowGoesOn() {
    QVERIFY(open_example("lenslets-30"));
    const auto image_before = session().document().image();
    session().document().set_value("flames[0].kind", "vdb");
    type("flames[0].file", "/no/such/flame.vdb");
    QVERIFY(until([&] { return window_->last_message().contains("/no/such/flame.vdb"); }));
    QVERIFY(window_->statusBar()->currentMessage().contains("/no/such/flame.vdb"));
    QVERIFY(session().document().image() == image_before);  // the last good one stays
    while (session().document().can_undo()) press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(settled());
    QVERIFY(session().document().image_is_current());
  }

  void crashIsSaidAndTheNextStartKnowsOfIt() {
    QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
    environment.insert("XDG_DATA_HOME", folder_->path());
    environment.insert("XDG_CONFIG_HOME", folder_->path());
    const QString scene = file("scene.toml"), data = file("plenoflame/plenoflame-desktop");
    QVERIFY(QFile::copy(":/examples/lenslets-30.toml", scene));
    QProcess program;
    program.setProcessEnvironment(environment);
    program.start(PLENOFLAME_DESKTOP, {scene});
    QVERIFY(program.waitForStarted(60000));
    QVERIFY(until([&] { return !QDir(data).entryList({"running-*"}).isEmpty(); }));
    // The mark is there before there is a window; after a while there are workers, too.
    QTest::qWait(300);
    QCOMPARE(::kill(static_cast<pid_t>(program.processId()), SIGSEGV), 0);
    QVERIFY(program.waitForFinished(test::kPatience));
    QCOMPARE(program.exitStatus(), QProcess::CrashExit);
    const QByteArray words = program.readAllStandardError();
    QVERIFY2(words.contains("ended unexpectedly"), words.constData());
    window_.reset();
    window_ = std::make_unique<MainWindow>(settings(), data.toStdString());
    window_->set_unattended(true);
    window_->show();
    window_->offer_recovery();
    QVERIFY(window_->statusBar()->currentMessage().contains("ended unexpectedly"));
  }

  void longExportIsCancelledAndOthersWaitTheirTurn() {
    QVERIFY(open_example("lenslets-30"));
    QDir(folder_->path()).mkdir("tool");
    answer_file_dialog(file("tool"));
    QVERIFY(click_menu({"File", "Export", "For another tool", "libpleno..."}));
    QVERIFY(window_->is_file_busy());
    auto* cancel = child<QPushButton>("fileTaskCancel");
    QVERIFY(until([&] { return cancel->isVisible(); }));
    QVERIFY(child<QLabel>("fileTaskLabel")->text().contains("export"));
    // Another one meanwhile: it waits.
    answer_file_dialog(file("raw.exr"));
    QVERIFY(click_menu({"File", "Export", "Light field (.exr) or developed picture (.png)..."}));
    QVERIFY(!QFile::exists(file("raw.exr")));
    // The window answers, too.
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(145, 150));
    QVERIFY(until([&] { return session().rays().rays() != nullptr; }));
    QVERIFY(window_->is_file_busy());
    QTest::mouseClick(cancel, Qt::LeftButton);
    QVERIFY(until([&] { return window_->last_message().contains("cancelled"); }));
    QVERIFY(written());
    QVERIFY(!QFile::exists(file("tool/params.js")));
    // A light field that was written is opened again, with its scene.
    const Scene scene_before = session().document().scene();
    const auto field = session().document().image();
    QVERIFY(QFile::exists(file("raw.exr")));
    answer_file_dialog(file("raw.exr"));
    press(Qt::Key_O, Qt::ControlModifier);
    QVERIFY(written());
    QVERIFY(session().document().image() != field);
    QVERIFY(session().document().image()->channels[0].flux.pixels ==
            field->channels[0].flux.pixels);
    QVERIFY(session().document().scene().camera == scene_before.camera);
    QVERIFY(session().document().image_is_current());
    QVERIFY(settled());
  }

  void sceneIsSavedUnderATypedName() {
    QVERIFY(open_example("lenslets-30"));
    type("camera.focus.object_distance", "1.25 m");
    QVERIFY(window_->isWindowModified());
    answer_file_dialog(file("mine"));  // no ending: that of a scene
    press(Qt::Key_S, Qt::ControlModifier | Qt::ShiftModifier);
    QVERIFY(QFile::exists(file("mine.toml")));
    QVERIFY(!window_->isWindowModified());
    QVERIFY(window_->windowTitle().contains("mine.toml"));
    const Scene read = read_scene_file(file("mine.toml").toStdString()).scene;
    QCOMPARE(read.camera.focus.object_distance, 1.25);
    QVERIFY(read.flames == session().document().scene().flames);
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_work_test() {
  return std::make_unique<WorkTest>();
}

#include "work_test.moc"

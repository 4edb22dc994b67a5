// Panels, files and pictures of the window, driven by clicks and keys. References: what the command
// makes of the same scene.
#include <QAction>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QDropEvent>
#include <QFile>
#include <QLabel>
#include <QListWidget>
#include <QMimeData>
#include <QProcess>
#include <QSet>
#include <QSlider>
#include <QStatusBar>
#include <QTabWidget>
#include <QTableWidget>
#include <QUrl>

#include "gui_tests.h"
#include "plenoflame/image/png_file.h"
#include "scenes.h"
#include "widgets/flame/flame_dialogs.h"
#include "widgets/flame/flame_panel.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/panels/scene_panel.h"
#include "widgets/scene/scene_view.h"
#include "window_fixture.h"

using namespace plenoflame;
using namespace plenoflame::desktop;
using plenoflame::desktop::test::difference;

class PanelsTest : public test::WindowFixture {
  Q_OBJECT

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void pixelsOnTheScreenAreThoseOfTheDevelopedPicture() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    session().document().save(folder_->filePath("scene.toml").toStdString());
    const QString raw = folder_->filePath("raw.exr"), png = folder_->filePath("raw.png");
    answer_file_dialog(raw);
    child<QAction>("exportImage")->trigger();
    QVERIFY(written());
    QVERIFY(QFile::exists(raw));
    run(PLENOFLAME_COMMAND, {"develop", raw, "-o", png});
    const PngImage developed = read_png(png.toStdString());
    child<QComboBox>("map")->setCurrentIndex(0);  // grey, as the command has it
    QTest::keyClick(&image(), Qt::Key_1);
    // So that pixels of the image and of the screen lie upon each other.
    image().centre_on(150 + 0.5 * (image().width() % 2), 150 + 0.5 * (image().height() % 2));
    const QImage shown = image().grab().toImage();
    int compared = 0;
    for (int row = 100; row < 200; row += 3)
      for (int column = 100; column < 200; column += 3) {
        const QPointF middle = image().to_widget(QPointF(column + 0.5, row + 0.5));
        const QPoint at(static_cast<int>(std::floor(middle.x())),
                        static_cast<int>(std::floor(middle.y())));
        const auto sample =
            developed.samples[static_cast<std::size_t>(row * developed.width + column)];
        const int expected = sample >> (developed.bits - 8);
        QVERIFY(std::abs(qRed(shown.pixel(at)) - expected) <= 2);
        ++compared;
      }
    QVERIFY(compared > 1000);
  }

  void colourIsThatOfTheDevelopedPicture() {
    std::string text = test::small_scene_text();
    for (const char* response : {"cie_x", "cie_y", "cie_z"})
      text += std::string("\n[[channels]]\nname = \"") + response +
              "\"\nkind = \"named\"\nresponse = \"" + response + "\"\n";
    write(file("colours.toml"), text.c_str());
    const QString raw = file("raw.exr"), png = file("colour.png");
    run(PLENOFLAME_COMMAND, {"render", file("colours.toml"), "-o", raw});
    run(PLENOFLAME_COMMAND, {"develop", raw, "--colour", "-o", png});
    const QImage developed(png);
    QVERIFY(!developed.isNull());
    QVERIFY(window_->open(raw));
    QVERIFY(written() && settled());
    auto* const channel = child<QComboBox>("channel");
    channel->setFocus();
    QTest::keyClick(channel, Qt::Key_End);
    QCOMPARE(channel->currentText(), QString("Colour"));
    QVERIFY(settled());
    QTest::keyClick(&image(), Qt::Key_1);
    image().centre_on(100 + 0.5 * (image().width() % 2), 90 + 0.5 * (image().height() % 2));
    const QImage shown = image().grab().toImage();
    int compared = 0, coloured = 0;
    for (int row = 40; row < 140; row += 3)
      for (int column = 50; column < 150; column += 3) {
        const QPointF middle = image().to_widget(QPointF(column + 0.5, row + 0.5));
        const QColor seen(shown.pixel(static_cast<int>(std::floor(middle.x())),
                                      static_cast<int>(std::floor(middle.y()))));
        const QColor expected(developed.pixel(column, row));
        QVERIFY(std::abs(seen.red() - expected.red()) <= 2);
        QVERIFY(std::abs(seen.green() - expected.green()) <= 2);
        QVERIFY(std::abs(seen.blue() - expected.blue()) <= 2);
        coloured += expected.red() > expected.blue() + 40 ? 1 : 0;
        ++compared;
      }
    QVERIFY(compared > 1000 && coloured > 100);
  }

  void apertureAndDepthAreDragged() {
    QVERIFY(window_->open_example("paper-previous-60x60"));
    show_tab(LightFieldPanel::Tab::views);
    QVERIFY(settled());
    QVERIFY(until([&] { return session().light_field().views() != nullptr; }));
    auto* pad = child<QWidget>("aperturePad");
    auto* view = child<ImageView>("subApertureView");
    const QImage middle = view->grab().toImage();
    QTest::mouseClick(pad, Qt::LeftButton, {}, pad->rect().center() + QPoint(0, pad->height() / 4));
    const QImage lower = view->grab().toImage();
    QVERIFY(difference(middle, lower) > 1e-3);
    QTest::keyClick(pad, Qt::Key_Up);
    QVERIFY(difference(lower, view->grab().toImage()) > 1e-4);
    show_tab(LightFieldPanel::Tab::refocus);
    auto* slider = child<QSlider>("depthSlider");
    auto* picture = child<ImageView>("refocusedView");
    const auto sharp = [&] {
      return session().light_field().refocused().image &&
             !session().light_field().refocused().preview;
    };
    QVERIFY(until(sharp));
    const QImage before = picture->grab().toImage();
    const double depth = window_->light_field_panel().depth();
    QElapsedTimer since;
    since.start();
    for (int i = 0; i < 10; ++i) QTest::keyClick(slider, Qt::Key_PageDown);
    QVERIFY(window_->light_field_panel().depth() < depth);
    const double wanted = window_->light_field_panel().depth();
    const auto shown = [&] {
      return std::fabs(session().light_field().refocused().depth / wanted - 1) < 1e-9;
    };
    QVERIFY(until(shown));
    qInfo("refocused after %lld ms (ten steps)", since.elapsed());
    QVERIFY(until([&] { return shown() && sharp(); }));
    QVERIFY(difference(before, picture->grab().toImage()) > 1e-3);
    // A number without a unit is refused at the field.
    auto* edit = child<QLineEdit>("depthEdit");
    edit->selectAll();
    QTest::keyClicks(edit, "2");
    QTest::keyClick(edit, Qt::Key_Return);
    QVERIFY(edit->styleSheet().contains("b3261e"));
    // So is a place that no lens focuses on, and the picture stays.
    for (const char* typed : {"-3 m", "10 mm"}) {
      edit->setFocus();
      edit->selectAll();
      QTest::keyClicks(edit, "1 m");  // not red any more, before it is
      QTest::keyClick(edit, Qt::Key_Return);
      QVERIFY(edit->styleSheet().isEmpty());
      edit->selectAll();
      QTest::keyClicks(edit, typed);
      QTest::keyClick(edit, Qt::Key_Return);
      QVERIFY(edit->styleSheet().contains("b3261e"));
      QCOMPARE(window_->light_field_panel().depth(), 1.0);
    }
    // The typed number is the one that counts, between the slider's steps and beyond them, and
    // stays when there is another picture of the same camera.
    auto* views = &session().light_field();
    for (const double typed : {1.0001, 7.5}) {
      edit->setFocus();
      edit->selectAll();
      QTest::keyClicks(edit, QString::number(typed) + " m");
      QTest::keyClick(edit, Qt::Key_Return);
      QVERIFY(edit->styleSheet().isEmpty());
      QCOMPARE(window_->light_field_panel().depth(), typed);
      const auto refocused = [&] { return views->refocused().depth == typed && sharp(); };
      QVERIFY(until(refocused));
      slider->setFocus();  // leaving the field, which shows fewer digits, changes nothing
      QCOMPARE(window_->light_field_panel().depth(), typed);
      const auto earlier = views->views();
      session().document().set_value("render.seed", std::to_string(static_cast<int>(typed) + 5));
      QVERIFY(until([&] { return views->views() && views->views() != earlier && refocused(); }));
      QCOMPARE(window_->light_field_panel().depth(), typed);
    }
    // All in focus, and an epipolar slice.
    show_tab(LightFieldPanel::Tab::total);
    QTest::mouseClick(child<QPushButton>("totalFocus"), Qt::LeftButton);
    QVERIFY2(
        until([&] { return child<ImageView>("totalFocusView")->image() != nullptr; }),
        qPrintable(window_->last_message() + "; " + window_->light_field_panel().shown_name()));
    show_tab(LightFieldPanel::Tab::slice);
    QVERIFY(child<ImageView>("epipolarView")->image() != nullptr);
    const QString path = folder_->filePath("slice.png");
    answer_file_dialog(path);
    QTest::mouseClick(child<QAbstractButton>("exportDerived"), Qt::LeftButton);
    QVERIFY(written());
    QVERIFY(QFile::exists(path));
  }

  void designIsTheCommandsAndFollowsEdits() {
    QVERIFY(window_->open_example("lenslets-30"));
    raise("designGroup");
    auto* table = child<QTableWidget>("designTable");
    const auto rows = [&] {
      QStringList texts;
      for (int i = 0; i < table->rowCount(); ++i)
        texts << table->item(i, 1)->text().section('\n', 0, 0);
      return texts;
    };
    const auto complete = [&] {
      return session().design().result() && session().design().result()->complete;
    };
    QVERIFY(until(complete));
    const QStringList before = rows();
    QVERIFY(before.size() > 15);
    // The slider of the tree moves a number; the report follows.
    window_->scene_panel().reveal("camera.focus.object_distance");
    raise("sceneGroup");
    auto* slider = child<QSlider>("parameterSlider");
    QVERIFY(slider->isEnabled());
    for (int i = 0; i < 5; ++i) QTest::keyClick(slider, Qt::Key_PageUp);
    QVERIFY(session().document().scene().camera.focus.object_distance > 1);
    QVERIFY(until([&] { return complete() && rows() != before; }));
    QVERIFY(until(complete));
    QVERIFY(settled());
    session().document().save(folder_->filePath("scene.toml").toStdString());
    const QString command = run(PLENOFLAME_COMMAND, {"design", folder_->filePath("scene.toml")});
    QVERIFY(!command.isEmpty());
    for (const QString& text : rows()) QVERIFY2(command.contains(text), qPrintable(text));
    // All steps of the slider are one to undo.
    QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(session().document().scene().camera.focus.object_distance, 1.0);
  }

  void flameIsGeneratedSlicedAndMapped() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    const QString path = folder_->filePath("candle.vdb");
    raise("flameGroup");
    when_shown<GenerateDialog>([&](GenerateDialog& dialog) {
      auto* edit = dialog.findChild<QLineEdit*>("field-voxel size");
      edit->selectAll();
      QTest::keyClicks(edit, "1 mm");
      answer_file_dialog(path);
      QTest::keyClick(&dialog, Qt::Key_Return);
    });
    QTest::mouseClick(child<QPushButton>("flameGenerate"), Qt::LeftButton);
    QVERIFY(until([&] {
      const auto& flames = session().document().scene().flames;
      return flames.size() == 1 && flames[0].kind == FlameKind::vdb;
    }));
    QVERIFY2(settled(), qPrintable(window_->last_message()));
    auto* summary = child<QLabel>("flameSummary");
    QVERIFY(until([&] { return summary->text().contains("absorption"); }));
    QVERIFY(summary->text().contains("1 mm"));  // of the voxels
    auto* slice = child<ImageView>("flameSlice");
    const QImage middle = slice->grab().toImage();
    QTest::keyClick(child<QSlider>("slicePosition"), Qt::Key_Home);
    QVERIFY(difference(middle, slice->grab().toImage()) > 1e-3);
    // A scale on temperature through the dialog; the flame gets hotter.
    const double hottest = window_->flame_panel().sampler().samples()->hottest;
    when_shown<MappingDialog>([](MappingDialog& dialog) {
      QVERIFY(dialog.findChild<QComboBox*>("TemperatureGrid")->itemText(0).contains("temperature"));
      dialog.findChildren<QDoubleSpinBox*>().front()->setValue(1.1);
      QTest::keyClick(&dialog, Qt::Key_Return);
    });
    QTest::mouseClick(child<QPushButton>("flameMapping"), Qt::LeftButton);
    QVERIFY(written());
    QCOMPARE(session().document().scene().flames[0].temperature.scale, 1.1);
    QVERIFY(until([&] {
      return std::fabs(window_->flame_panel().sampler().samples()->hottest / hottest / 1.1 - 1) <
             1e-3;
    }));
  }

  void outlinesAndQuantitiesChangeThePicture() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    image().set_scale(6);
    image().centre_on(150, 150);
    const QImage plain = image().grab().toImage();
    QTest::keyClick(&image(), Qt::Key_O);
    QVERIFY(until([&] { return session().light_field().outlines() != nullptr; }));
    QTest::qWait(50);
    QVERIFY(difference(plain, image().grab().toImage()) > 5e-3);
    QTest::keyClick(&image(), Qt::Key_O);
    QCOMPARE(difference(plain, image().grab().toImage()), 0.0);
    auto* map = child<QComboBox>("map");
    QTest::keyClick(map, Qt::Key_Up);
    QVERIFY(difference(plain, image().grab().toImage()) > 0.5);
    QTest::keyClick(map, Qt::Key_Down);
    auto* quantity = child<QComboBox>("quantity");
    QTest::keyClick(quantity, Qt::Key_End);
    QVERIFY(until([&] { return difference(plain, image().grab().toImage()) > 0.1; }));
    // A line across the image becomes a profile.
    QTest::mousePress(&image(), Qt::LeftButton, Qt::ControlModifier, QPoint(60, 80));
    QTest::mouseMove(&image(), QPoint(150, 80));
    QTest::mouseRelease(&image(), Qt::LeftButton, Qt::ControlModifier, QPoint(260, 80));
  }

  void filesAreDroppedSavedAndRemembered() {
    QFile example(":/examples/lenslets-30.toml");
    QVERIFY(example.open(QIODevice::ReadOnly));
    const QString path = folder_->filePath("mine.toml");
    QFile copy(path);
    QVERIFY(copy.open(QIODevice::WriteOnly));
    copy.write(example.readAll());
    copy.close();
    QMimeData data;
    data.setUrls({QUrl::fromLocalFile(path)});
    QDragEnterEvent enter(QPoint(100, 100), Qt::CopyAction, &data, Qt::LeftButton, {});
    QApplication::sendEvent(window_.get(), &enter);
    QVERIFY(enter.isAccepted());
    QDropEvent drop(QPoint(100, 100), Qt::CopyAction, &data, Qt::LeftButton, {});
    QApplication::sendEvent(window_.get(), &drop);
    QCOMPARE(session().document().file(), path.toStdString());
    QVERIFY(window_->windowTitle().contains("mine.toml"));
    // Nothing to save: the comments of the file stay in it.
    QTest::keyClick(window_.get(), Qt::Key_S, Qt::ControlModifier);
    QVERIFY(window_->statusBar()->currentMessage().contains("no changes"));
    QVERIFY(copy.open(QIODevice::ReadOnly));
    QVERIFY(copy.readAll().startsWith("#"));
    copy.close();
    session().document().set_value("render.samples", "8");
    QVERIFY(window_->isWindowModified());
    QTest::keyClick(window_.get(), Qt::Key_S, Qt::ControlModifier);
    QVERIFY(!window_->isWindowModified());
    QVERIFY(window_->statusBar()->currentMessage().contains("mine.toml saved"));
    QVERIFY(copy.open(QIODevice::ReadOnly));
    QVERIFY(copy.readAll().contains("samples = 8"));
    // A file that is no good: the message of the command, and everything stays.
    QFile bad(folder_->filePath("bad.toml"));
    QVERIFY(bad.open(QIODevice::WriteOnly));
    bad.write("[camera]\npreset = \"paper\"\n");
    bad.close();
    QVERIFY(!window_->open(bad.fileName()));
    QProcess command;
    command.start(PLENOFLAME_COMMAND, {"info", bad.fileName()});
    QVERIFY(command.waitForFinished(test::kPatience));
    QVERIFY2(QString::fromUtf8(command.readAllStandardError()).contains(window_->last_message()),
             qPrintable(window_->last_message()));
    QCOMPARE(session().document().file(), path.toStdString());
    // The next window knows the file and the theme.
    child<QAction>("actionDark")->trigger();
    window_->close();
    window_.reset();
    make_window();
    QCOMPARE(child<QListWidget>("recentFiles")->count(), 1);
    QVERIFY(child<QAction>("actionDark")->isChecked());
    QVERIFY(window_->palette().color(QPalette::Window).lightness() < 100);
    child<QAction>("actionDark")->trigger();
  }

  void unsavedSceneIsRecovered() {
    QVERIFY(window_->open_example("lenslets-30"));
    session().document().set_value("camera.focus.object_distance", "1.3 m");
    // A program that ended badly leaves its copy, with the number of a process that is gone.
    QProcess gone;
    gone.start("true", QStringList());
    const qint64 process = gone.processId();
    gone.waitForFinished(test::kPatience);
    Recovery recovery(folder_->filePath("recovery").toStdString());
    recovery.keep(session().document());
    QVERIFY(QFile::rename(QString::fromStdString(recovery.path()),
                          folder_->filePath(QString("recovery/recovery-%1.toml").arg(process))));
    session().document().undo();
    window_->offer_recovery();
    QCOMPARE(session().document().scene().camera.focus.object_distance, 1.3);
    QVERIFY(window_->isWindowModified());
  }

  void screenshotOptionWritesThePicture() {
    const QString out = folder_->filePath("shot.png"), scene = folder_->filePath("scene.toml");
    QFile::copy(":/examples/lenslets-30.toml", scene);
    run(PLENOFLAME_DESKTOP,
        {scene, "--screenshot", out, "--size", "1300x800", "--pixel", "150,150"});
    const QImage shot(out);
    QCOMPARE(shot.size(), QSize(1300, 800));
    // The 3-D view is in it: more than one colour in the part where it stands.
    QSet<QRgb> colours;
    for (int y = 100; y < 600; y += 4)
      for (int x = 280; x < 600; x += 4) colours.insert(shot.pixel(x, y));
    QVERIFY2(colours.size() > 30, qPrintable(QString::number(colours.size())));
    QProcess wrong;
    wrong.start(PLENOFLAME_DESKTOP, {"/no/such/scene.toml", "--screenshot", out});
    QVERIFY(wrong.waitForFinished(test::kPatience));
    QCOMPARE(wrong.exitCode(), 1);
    QVERIFY(wrong.readAllStandardError().contains("/no/such/scene.toml"));
  }

  void screenshotOptionEndsWhereThereIsNothingToWaitFor() {
    const QString out = folder_->filePath("shot.png"), good = folder_->filePath("good.toml"),
                  bad = folder_->filePath("bad.toml");
    QFile::copy(":/examples/lenslets-30.toml", good);
    write(bad, "");
    struct Case {
      QStringList arguments;
      int status;
      const char* words;
    };
    for (const Case& one : {Case{{bad, "--screenshot", out}, 1, "camera.sensor.columns is missing"},
                            {{good, "--screenshot", "/no/such/folder/shot.png"}, 1, "/no/such"},
                            {{good, "--screenshot", out, "--depth", "0 m"}, 2, "--depth: "},
                            {{good, "--screenshot", out, "--depth", "10 mm"}, 1, "focal plane"},
                            {{good, "--screenshot", out, "--pixel", "9999,3"}, 2, "300 x 300"}}) {
      QProcess program;
      program.start(PLENOFLAME_DESKTOP, one.arguments);
      QVERIFY(program.waitForFinished(test::kPatience));
      QCOMPARE(program.exitCode(), one.status);
      QVERIFY(program.readAllStandardError().contains(one.words));
      QVERIFY(!QFile::exists(out));
    }
  }

  void pixelBesideTheSensorOfALightFieldIsRefused() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    const QString raw = folder_->filePath("raw.exr"), out = folder_->filePath("shot.png");
    write_light_field(raw.toStdString(), *session().document().image());
    // With somebody in front of it, too: the file is read while the window is there already.
    for (const QStringList& more : {QStringList{}, {"--screenshot", out}}) {
      QProcess program;
      program.start(PLENOFLAME_DESKTOP, QStringList{raw, "--pixel", "9999,3"} + more);
      QVERIFY(program.waitForFinished(test::kPatience));
      QCOMPARE(program.exitCode(), 2);
      const QByteArray said = program.readAllStandardError();
      QVERIFY2(said.count("error: ") == 1 && said.contains("300 x 300"), said.constData());
      QVERIFY(!QFile::exists(out));
    }
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_panels_test() {
  return std::make_unique<PanelsTest>();
}

#include "panels_test.moc"

// Files that come in: simulations, recent files, what a crash left behind.
#include <unistd.h>

#include <QComboBox>
#include <QDir>
#include <QFile>
#include <QListWidget>
#include <QMessageBox>
#include <QPushButton>
#include <QStatusBar>
#include <QTableWidget>

#include "gui_tests.h"
#include "plenoflame/base/error.h"
#include "widgets/flame/flame_panel.h"
#include "widgets/window/import_dialog.h"
#include "window_fixture.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class FilesTest : public test::WindowFixture {
  Q_OBJECT

  /// A simulation on 12 x 12 x 12 points, 5 mm apart: T = 1000 K + 50 K per point along z.
  QByteArray simulation() {
    constexpr int kPoints = 12;
    QByteArray t, k;
    for (int z = 0; z < kPoints; ++z)
      for (int i = 0; i < kPoints * kPoints; ++i) {
        t += QByteArray::number(1000 + 50 * z) + '\n';
        k += "12\n";
      }
    const QByteArray array =
        "<DataArray type=\"Float32\" Name=\"%1\" format=\"ascii\">\n%2</DataArray>\n";
    const auto filled = [&](const char* name, const QByteArray& values) {
      return QByteArray(array).replace("%1", name).replace("%2", values);
    };
    return "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
           "<ImageData WholeExtent=\"0 11 0 11 0 11\" Origin=\"-0.03 -0.03 0\" "
           "Spacing=\"0.005 0.005 0.005\">\n<Piece Extent=\"0 11 0 11 0 11\">\n<PointData>\n" +
           filled("T", t) + filled("kappa", k) +
           "</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n";
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void simulationIsImportedThroughTheDialog() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    write(file("burner.vti"), simulation());
    raise("flameGroup");
    const auto flames_before = session().document().scene().flames;
    when_shown<ImportDialog>([&](ImportDialog& dialog) {
      const auto type = [&](const char* name, const QString& text) {
        auto* edit = dialog.findChild<QLineEdit*>(name);
        // A field tells that it was left when it had the focus, which a dialog that is not active
        // does not give; there is no window manager to activate it.
        QVERIFY(until([&] {
          QApplication::setActiveWindow(&dialog);
          edit->setFocus();
          return edit->hasFocus();
        }));
        edit->selectAll();
        QTest::keyClicks(edit, text);
      };
      // Nothing chosen yet: said in the dialog, which stays.
      QTest::keyClick(&dialog, Qt::Key_Return);
      QVERIFY(dialog.isVisible());
      auto* message = dialog.findChild<QWidget*>("importMessage");
      QVERIFY(message->isVisible());
      type("importFile", file("burner.vti"));
      type("importTemperature", "T");  // leaves the field of the file: its arrays are listed
      auto* arrays = dialog.findChild<QTableWidget*>("importArrays");
      QVERIFY(until([&] { return arrays->rowCount() == 2; }));
      QStringList listed;
      for (int row = 0; row < 2; ++row)
        for (int k = 0; k < 3; ++k) listed << arrays->item(row, k)->text();
      QCOMPARE(listed, (QStringList{"T", "1000", "1550", "kappa", "12", "12"}));
      // The field that was used last takes the array that is double-clicked.
      dialog.findChild<QLineEdit*>("importSource")->setFocus();
      const QPoint row = arrays->visualItemRect(arrays->item(1, 0)).center();
      QTest::mouseClick(arrays->viewport(), Qt::LeftButton, {}, row);
      QTest::mouseDClick(arrays->viewport(), Qt::LeftButton, {}, row);
      QCOMPARE(dialog.findChild<QLineEdit*>("importSource")->text(), QString("kappa"));
      type("importVoxelSize", "5 kg");
      QTest::keyClick(&dialog, Qt::Key_Return);
      QVERIFY(dialog.isVisible());
      QVERIFY(session().document().scene().flames == flames_before);
      type("importVoxelSize", "5 mm");
      answer_file_dialog(file("burner.vdb"));
      QTest::keyClick(&dialog, Qt::Key_Return);
    });
    QTest::mouseClick(child<QPushButton>("flameImport"), Qt::LeftButton);
    QVERIFY2(until([&] {
               const auto& flames = session().document().scene().flames;
               return flames.size() == 1 && flames[0].kind == FlameKind::vdb;
             }),
             qPrintable(window_->last_message()));
    QVERIFY2(settled(), qPrintable(window_->last_message()));
    const auto samples = [&] { return window_->flame_panel().sampler().samples(); };
    QVERIFY(until([&] { return samples() && samples()->hottest > 1500; }));
    QVERIFY(samples()->hottest <= 1550 * (1 + 1e-6));
    QVERIFY(std::fabs(samples()->densest / 12 - 1) < 1e-5);
  }

  void cancelledImportLeavesNothing() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    write(file("burner.vti"), simulation());
    QVERIFY(QDir(folder_->path()).mkdir("out"));
    raise("flameGroup");
    const Scene before = session().document().scene();
    cancel_at_once([&] {
      when_shown<ImportDialog>([&](ImportDialog& dialog) {
        QTest::keyClicks(dialog.findChild<QLineEdit*>("importFile"), file("burner.vti"));
        QTest::keyClicks(dialog.findChild<QLineEdit*>("importSource"), "kappa");
        // Millions of voxels: it cannot have ended before it is cancelled.
        QTest::keyClicks(dialog.findChild<QLineEdit*>("importVoxelSize"), "0.4 mm");
        answer_file_dialog(file("out/burner.vdb"));
        QTest::keyClick(&dialog, Qt::Key_Return);
      });
      QTest::mouseClick(child<QPushButton>("flameImport"), Qt::LeftButton);
    });
    QVERIFY(session().document().scene() == before);
    QVERIFY(QDir(file("out")).isEmpty());
  }

  void whatIsDoneWhileAFileIsReadCounts() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    session().document().save(file("mine.toml").toStdString());
    write_light_field(file("raw.exr").toStdString(), *session().document().image());
    // The file that was opened last is open in the end, however long the other one takes.
    QVERIFY(window_->open(file("raw.exr")));
    QVERIFY(window_->open(file("mine.toml")));
    QVERIFY(written());
    QCOMPARE(session().document().file(), file("mine.toml").toStdString());
    // The other one is not forgotten in silence.
    const QString said = window_->statusBar()->currentMessage();
    QVERIFY2(said.contains("raw.exr") && said.contains("not opened"), qPrintable(said));
    // Changes that came in between are asked about, not thrown away.
    window_->set_unattended(false);
    int questions = 0;
    bool then = false;
    when_shown<QMessageBox>([&](QMessageBox& box) {
      ++questions;
      QTest::keyClick(&box, Qt::Key_Escape);
    });
    QVERIFY(window_->open(file("raw.exr"), [&] { then = true; }));
    session().document().set_value("camera.focus.object_distance", "1.25 m");
    QVERIFY(written());
    QCOMPARE(questions, 1);
    QCOMPARE(session().document().scene().camera.focus.object_distance, 1.25);
    QVERIFY(!then);
    window_->set_unattended(true);
    // Work that waits for a file begins after it is there.
    QVERIFY(window_->open(file("raw.exr"), [&] {
      then = session().document().image() && session().document().file().empty();
    }));
    QVERIFY(written());
    QVERIFY(then);
  }

  void arrayThatIsNotThereIsSaidAndNothingChanges() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    write(file("burner.vti"), simulation());
    raise("flameGroup");
    const Scene before = session().document().scene();
    when_shown<ImportDialog>([&](ImportDialog& dialog) {
      QTest::keyClicks(dialog.findChild<QLineEdit*>("importFile"), file("burner.vti"));
      QTest::keyClicks(dialog.findChild<QLineEdit*>("importSource"), "soot");
      answer_file_dialog(file("burner.vdb"));
      QTest::keyClick(&dialog, Qt::Key_Return);
    });
    QTest::mouseClick(child<QPushButton>("flameImport"), Qt::LeftButton);
    QVERIFY(until([&] { return !window_->last_message().isEmpty(); }));
    QVERIFY2(window_->last_message().contains("soot"), qPrintable(window_->last_message()));
    QVERIFY(session().document().scene() == before);
    QVERIFY(!QFile::exists(file("burner.vdb")));
  }

  void recentFilesOpenFromTheMenuAndTheWelcomePage() {
    for (const char* name : {"one.toml", "two.toml"})
      QVERIFY(QFile::copy(":/examples/lenslets-30.toml", file(name)));
    for (const char* name : {"one.toml", "two.toml"}) {
      answer_file_dialog(file(name));
      press(Qt::Key_O, Qt::ControlModifier);
      QCOMPARE(session().document().file(), file(name).toStdString());
    }
    QVERIFY(click_menu({"File", "Open recent", file("one.toml")}));
    QCOMPARE(session().document().file(), file("one.toml").toStdString());
    QVERIFY(click_menu({"File", "Welcome page"}));
    auto* list = child<QListWidget>("recentFiles");
    QVERIFY(list->isVisible());
    QCOMPARE(list->count(), 2);
    QVERIFY(list->item(0)->text().startsWith("one.toml"));  // the last one first
    list->setFocus();
    list->setCurrentRow(1);
    QTest::keyClick(list, Qt::Key_Return);
    QCOMPARE(session().document().file(), file("two.toml").toStdString());
    // There is a way back to what is open.
    QVERIFY(click_menu({"File", "Welcome page"}));
    QVERIFY(child<QWidget>("welcomePage")->isVisible());
    QVERIFY(child<QPushButton>("welcomeBack")->isVisible());
    QTest::mouseClick(child<QPushButton>("welcomeBack"), Qt::LeftButton);
    QVERIFY(!child<QWidget>("welcomePage")->isVisible());
    QCOMPARE(session().document().file(), file("two.toml").toStdString());
    // One that is gone: said, and the document stays.
    QVERIFY(QFile::remove(file("one.toml")));
    QVERIFY(click_menu({"File", "Open recent", file("one.toml")}));
    QVERIFY(window_->last_message().contains("one.toml"));
    QCOMPARE(session().document().file(), file("two.toml").toStdString());
  }

  void sceneOfAProgramThatCrashedIsOffered() {
    const QString scene = file("scene.toml"), left = file("left");
    QVERIFY(QFile::copy(":/examples/lenslets-30.toml", scene));
    QProcess program;
    program.start(QCoreApplication::applicationFilePath(), {"crash", scene, left});
    QVERIFY(program.waitForFinished(test::kPatience));
    QCOMPARE(program.exitStatus(), QProcess::CrashExit);
    // The next program asks; yes.
    window_.reset();
    window_ = std::make_unique<MainWindow>(settings(), left.toStdString());
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    QString question;
    when_shown<QMessageBox>([&](QMessageBox& box) {
      question = box.text();
      QTest::mouseClick(box.button(QMessageBox::Yes), Qt::LeftButton);
    });
    window_->offer_recovery();
    QVERIFY2(question.contains("scene.toml"), qPrintable(question));
    QCOMPARE(session().document().scene().camera.focus.object_distance, 1.37);
    QCOMPARE(session().document().file(), scene.toStdString());
    QVERIFY(window_->isWindowModified());
    window_->set_unattended(true);
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_files_test() {
  return std::make_unique<FilesTest>();
}

int plenoflame::desktop::test::crash_with_changes(const char* scene, const char* recovery_folder) {
  QTemporaryDir folder;
  MainWindow window(
      std::make_unique<QSettings>(folder.filePath("settings.ini"), QSettings::IniFormat),
      recovery_folder);
  window.set_unattended(true);
  window.show();
  if (!window.open(scene)) return 2;
  window.session().document().set_value("camera.focus.object_distance", "1.37 m");
  const QDir kept(recovery_folder);
  if (!until([&] { return !kept.entryList({"recovery-*.toml"}).isEmpty(); })) return 3;
  std::abort();
}

#include "files_test.moc"

// Everything that can be exported, from the menu. References: the files that the command writes,
// and for other tools (finding micro-images takes long) those of the library.
#include <QAction>
#include <QComboBox>
#include <QDir>
#include <QDirIterator>
#include <QFile>
#include <QMessageBox>
#include <QPushButton>
#include <QSpinBox>
#include <QTabWidget>
#include <algorithm>
#include <cstdlib>

#include "gui_tests.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/lightfield/export.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/window/poster_dialog.h"
#include "window_fixture.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class ExportsTest : public test::WindowFixture {
  Q_OBJECT

  QString file(const QString& name) const { return folder_->filePath(name); }
  static QByteArray content(const QString& path) {
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
  }
  /// Names of the files below a folder, relative to it.
  static QStringList names(const QString& folder) {
    QStringList found;
    QDirIterator at(folder, QDir::Files, QDirIterator::Subdirectories);
    while (at.hasNext()) found << QDir(folder).relativeFilePath(at.next());
    found.sort();
    return found;
  }
  /// The scene as a file, and its light field as the command renders it.
  void save_for_the_command() {
    session().document().save(file("scene.toml").toStdString());
    run(PLENOFLAME_COMMAND, {"render", "--quiet", file("scene.toml"), "-o", file("raw.exr")});
    QVERIFY(QFile::exists(file("raw.exr")));
  }
  /// The middle of an example's sensor: few microlenses, so that the tools' files are made quickly.
  void open_part_of(const QString& example, const std::string& side) {
    QVERIFY(window_->open_example(example));
    for (const char* key : {"camera.sensor.columns", "camera.sensor.rows"})
      session().document().set_value(key, side);
    session().document().set_value("render.samples", "8");
    QVERIFY(settled());
    show_tab(LightFieldPanel::Tab::views);
    QVERIFY(until([&] { return session().light_field().micro_images() != nullptr; }));
  }
  /// Writes the files of a tool from the menu, and beside them what the library makes of the same
  /// light field. False: it cannot, and the window says the same words.
  bool export_for(const QString& format) {
    const QString own = "own-" + format, reference = "reference-" + format;
    const auto& formats = export_formats();
    const auto* const known = std::find_if(formats.begin(), formats.end(), [&](const auto& f) {
      return format == QLatin1String(f.name);
    });
    ExportResult expected;
    std::string refusal;
    QDir(folder_->path()).mkdir(reference);
    try {
      ExportSettings settings;
      settings.format = known->format;
      check_export(session().compiler().compiled()->camera, settings.format);
      expected =
          export_light_field(*session().document().image(), *session().light_field().micro_images(),
                             settings, file(reference).toStdString());
      QDir(folder_->path()).mkdir(own);
      answer_file_dialog(file(own));
    } catch (const InputError& error) {
      refusal = error.what();
    }
    const auto complain = [](const QString& text) {
      QTest::qFail(qPrintable(text), __FILE__, __LINE__);
      return false;
    };
    if (!click_menu({"File", "Export", "For another tool", format + "..."}))
      return complain("no menu for " + format);
    const auto is_about = [&] { return window_->last_message().contains(own); };
    if (!refusal.empty()) {
      const bool same = window_->last_message() == QString::fromStdString(refusal);
      return same ? false : complain(window_->last_message());
    }
    if (!until(is_about)) return complain(window_->last_message());
    const QStringList files = names(file(own));
    if (files.isEmpty() || files != names(file(reference))) return complain(files.join(' '));
    for (const QString& name : files) {
      const QByteArray a = content(file(own + "/" + name)),
                       b = content(file(reference + "/" + name));
      qsizetype differing = std::abs(a.size() - b.size());
      for (qsizetype i = 0; i < std::min(a.size(), b.size()); ++i)
        if (a[static_cast<int>(i)] != b[static_cast<int>(i)]) ++differing;
      // HDF5 writes down when an array was made: four bytes each.
      const bool dated = name.endsWith(".h5") || name.endsWith(".vox");
      if (differing > (dated ? 64 : 0)) return complain(name);
    }
    // Properties that the tool cannot be told are named here, too.
    for (const std::string& note : expected.notes)
      if (!window_->last_message().contains(QString::fromStdString(note)))
        return complain(window_->last_message());
    return true;
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void cancelledExportsLeaveNothing() {
    open_part_of("paper-previous-60x60", "300");
    QVERIFY(until([&] { return session().light_field().views() != nullptr; }));
    for (const QStringList& entry :
         {QStringList{"All views..."}, {"For another tool", "view-grid..."}}) {
      QDir(folder_->path()).mkdir("out");
      cancel_at_once([&] {
        answer_file_dialog(file("out"));
        QVERIFY(click_menu(QStringList{"File", "Export"} + entry));
      });
      QVERIFY(QDir(file("out"))
                  .entryList(QDir::AllEntries | QDir::Hidden | QDir::NoDotAndDotDot)
                  .isEmpty());
    }
  }

  void picturesOfAnEarlierCameraAreExportedWithThatCamera() {
    open_part_of("lenslets-30", "200");
    const auto write = [&](const QString& name) {
      QDir(folder_->path()).mkdir(name);
      answer_file_dialog(file(name));
      QVERIFY(click_menu({"File", "Export", "For another tool", "pip..."}));
      QVERIFY(written());
    };
    write("before");
    QTest::mouseClick(child<QAbstractButton>("renderAutomatic"), Qt::LeftButton, {}, QPoint(8, 8));
    const auto image = session().document().image();
    const auto compiled = session().compiler().compiled();
    session().document().set_value("camera.array.rotation", "3 deg");
    QVERIFY(until([&] {
      return session().compiler().is_current() && session().compiler().compiled() != compiled;
    }));
    QVERIFY(session().document().image() == image);
    write("after");
    QVERIFY(!names(file("before")).isEmpty());
    QCOMPARE(names(file("after")), names(file("before")));
    for (const QString& name : names(file("before")))
      QVERIFY2(content(file("after/" + name)) == content(file("before/" + name)), qPrintable(name));
  }

  void raysAreTheCommandsInEveryFormat() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    QVERIFY(click_menu({"File", "Export", "Rays of the selection..."}));
    QVERIFY(window_->last_message().contains("click a pixel"));
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(145, 150));
    const Selection selected = session().document().selection();
    QVERIFY(until([&] { return session().rays().rays() != nullptr; }));
    session().document().save(file("scene.toml").toStdString());
    for (const QString format : {"csv", "json", "vtp"}) {
      const QString own = file("own." + format), reference = file("command." + format);
      answer_file_dialog(own);
      QVERIFY(click_menu({"File", "Export", "Rays of the selection..."}));
      QVERIFY(written());
      run(PLENOFLAME_COMMAND, {"rays", file("scene.toml"), "--pixel",
                               QString("%1,%2").arg(selected.column).arg(selected.row), "--rays",
                               QString::number(RaySelector::kRaysPerPixel), "-o", reference});
      QVERIFY(!content(own).isEmpty());
      QCOMPARE(content(own).size(), content(reference).size());
      QVERIFY2(content(own) == content(reference), qPrintable(format));
    }
    // A name that means nothing: said, and nothing is written.
    answer_file_dialog(file("rays.xyz"));
    QVERIFY(click_menu({"File", "Export", "Rays of the selection..."}));
    QVERIFY(written());
    QVERIFY(window_->last_message().contains("rays.xyz"));
    QVERIFY(!QFile::exists(file("rays.xyz")));
  }

  void imageIsTheCommandsAndWrongNamesAreSaid() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    save_for_the_command();
    const QString item = "Light field (.exr) or developed picture (.png)...";
    answer_file_dialog(file("own.exr"));
    QVERIFY(click_menu({"File", "Export", item}));
    QVERIFY(written());
    const LightField own = read_light_field(file("own.exr").toStdString()),
                     command = read_light_field(file("raw.exr").toStdString());
    QVERIFY(own.channels[0].flux.pixels == command.channels[0].flux.pixels);
    QVERIFY(own.channels[0].standard_error.pixels == command.channels[0].standard_error.pixels);
    answer_file_dialog(file("own.png"));
    QVERIFY(click_menu({"File", "Export", item}));
    QVERIFY(written());
    run(PLENOFLAME_COMMAND, {"develop", file("raw.exr"), "-o", file("raw.png")});
    QVERIFY(read_png(file("own.png").toStdString()).samples ==
            read_png(file("raw.png").toStdString()).samples);
    answer_file_dialog(file("own.bmp"));
    QVERIFY(click_menu({"File", "Export", item}));
    QVERIFY(written());
    QVERIFY(window_->last_message().contains("must end in"));
    answer_file_dialog("/no/such/folder/own.exr");
    QVERIFY(click_menu({"File", "Export", item}));
    QVERIFY(written());
    QVERIFY(!QFile::exists("/no/such/folder/own.exr"));
  }

  void pictureOfTheSceneIsWhatIsShown() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    answer_file_dialog(file("scene.png"));
    QVERIFY(click_menu({"File", "Export", "Picture of the 3-D view..."}));
    QVERIFY(written());
    const QImage kept(file("scene.png"));
    QCOMPARE(test::difference(kept, window_->scene_view().picture()), 0.0);
  }

  void posterHasTheSizeAndTheGroundThatAreAskedFor() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    press(Qt::Key_2, Qt::ControlModifier);
    QVERIFY(settled());
    const QImage before = window_->scene_view().picture();
    const FlameLook look = session().document().look();
    when_shown<PosterDialog>([&](PosterDialog& dialog) {
      QTest::keyClick(dialog.findChild<QComboBox*>("posterOf"), Qt::Key_End);
      QTest::keyClick(dialog.findChild<QComboBox*>("posterBackground"), Qt::Key_End);
      for (const auto& [name, value] :
           {std::pair{"posterWidth", "1800"}, {"posterHeight", "900"}}) {
        auto* const box = dialog.findChild<QSpinBox*>(name);
        box->selectAll();
        QTest::keyClicks(box, value);
      }
      answer_file_dialog(file("poster.png"));
      QTest::keyClick(&dialog, Qt::Key_Return);
    });
    QVERIFY(click_menu({"File", "Export", "Picture of any size..."}));
    QVERIFY(written());
    const QImage poster(file("poster.png"));
    QCOMPARE(poster.size(), QSize(1800, 900));
    for (const QPoint corner : {QPoint(1, 1), QPoint(1, 898), QPoint(898, 898)})
      QCOMPARE(QColor(poster.pixel(corner)), QColor(Qt::white));
    // The flame fills its half, orange; the light field reaches from edge to edge of its own.
    int top = 900, bottom = 0, dark = 0;
    for (int y = 0; y < 900; ++y) {
      for (int x = 200; x < 700; ++x) {
        const QColor c(poster.pixel(x, y));
        if (c.red() < c.blue() + 80) continue;
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
      dark += qGray(poster.pixel(905, y)) < 100 ? 1 : 0;
    }
    QVERIFY2(bottom - top > 450, qPrintable(QString("%1 to %2").arg(top).arg(bottom)));
    QVERIFY2(dark > 850, qPrintable(QString::number(dark)));
    // The scale bar of the dark light field has the ground of the poster, too.
    QCOMPARE(QColor(poster.pixel(938, 862)), QColor(Qt::white));
    // Nothing has changed in the window.
    QVERIFY(session().document().look() == look);
    QVERIFY(test::difference(before, window_->scene_view().picture()) < 1e-3);
  }

  void filesForOtherToolsAreTheLibrarys() {
    open_part_of("lenslets-30", "100");
    int done = 0;
    for (const ExportName& format : export_formats()) done += export_for(format.name) ? 1 : 0;
    QCOMPARE(done, 9);  // plenopticam wants an unfocused camera
  }

  void filesOfAnUnfocusedCameraAreTheLibrarys() {
    open_part_of("paper-previous-60x60", "150");
    QVERIFY(export_for("plenopticam"));
    QVERIFY(!export_for("pip"));  // wants a hexagonal array
  }

  void folderWithFilesIsAskedAbout() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    QDir(folder_->path()).mkdir("full");
    QFile there(file("full/mine.txt"));
    QVERIFY(there.open(QIODevice::WriteOnly));
    there.close();
    window_->set_unattended(false);
    bool asked = false;
    answer_file_dialog(file("full"));
    when_shown<QMessageBox>([&](QMessageBox& box) {
      asked = box.text().contains("full");
      QTest::mouseClick(box.button(QMessageBox::No), Qt::LeftButton);
    });
    QVERIFY(click_menu({"File", "Export", "For another tool", "npz..."}));
    window_->set_unattended(true);
    QVERIFY(asked);
    QCOMPARE(names(file("full")), QStringList{"mine.txt"});
  }

  void viewsAndDerivedPicturesAreTheCommands() {
    QVERIFY(window_->open_example("paper-previous-60x60"));
    QVERIFY(click_menu({"File", "Export", "All views..."}));
    QVERIFY(window_->last_message().contains("light-field panel"));
    show_tab(LightFieldPanel::Tab::views);
    QVERIFY(settled());
    QVERIFY(until([&] { return session().light_field().views() != nullptr; }));
    save_for_the_command();
    QDir(folder_->path()).mkdir("own");
    answer_file_dialog(file("own"));
    QVERIFY(click_menu({"File", "Export", "All views..."}));
    QVERIFY(written());
    run(PLENOFLAME_COMMAND,
        {"views", file("raw.exr"), "--grid", QString::number(LightFieldJobs::kGrid), "--exr", "-o",
         file("command")});
    const QStringList own = names(file("own")), command = names(file("command"));
    QVERIFY(own.size() > LightFieldJobs::kGrid * LightFieldJobs::kGrid);
    int compared = 0;
    for (const QString& name : own) {
      if (!name.endsWith(".exr") || !command.contains(name)) continue;
      const LightField a = read_light_field(file("own/" + name).toStdString()),
                       b = read_light_field(file("command/" + name).toStdString());
      QVERIFY2(a.channels[0].flux.pixels == b.channels[0].flux.pixels, qPrintable(name));
      ++compared;
    }
    QVERIFY2(compared >= LightFieldJobs::kGrid * LightFieldJobs::kGrid,
             qPrintable(own.join(' ') + " | " + command.join(' ')));
    // The refocused picture: its values, by the menu.
    show_tab(LightFieldPanel::Tab::refocus);
    auto* edit = child<QLineEdit>("depthEdit");
    edit->selectAll();
    QTest::keyClicks(edit, "0.9 m");
    QTest::keyClick(edit, Qt::Key_Return);
    QVERIFY(until([&] {
      const DerivedImage& r = session().light_field().refocused();
      return r.image && !r.preview && r.depth == window_->light_field_panel().depth();
    }));
    answer_file_dialog(file("refocused.exr"));
    QVERIFY(click_menu({"File", "Export", "Picture of the light-field panel..."}));
    QVERIFY(written());
    run(PLENOFLAME_COMMAND, {"refocus", file("raw.exr"), "--depth",
                             QString::number(window_->light_field_panel().depth(), 'g', 17) + " m",
                             "--exr", "-o", file("refocus")});
    const LightField mine = read_light_field(file("refocused.exr").toStdString());
    bool found = false;
    for (const QString& name : names(file("refocus"))) {
      if (!name.endsWith(".exr")) continue;
      const LightField theirs = read_light_field(file("refocus/" + name).toStdString());
      found |= theirs.channels[0].flux.pixels == mine.channels[0].flux.pixels;
    }
    QVERIFY2(found, qPrintable(names(file("refocus")).join(' ')));
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_exports_test() {
  return std::make_unique<ExportsTest>();
}

#include "exports_test.moc"

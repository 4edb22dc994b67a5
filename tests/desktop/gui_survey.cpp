// Whatever can be done with the window, and how long it does not answer meanwhile; run by hand, see
// docs/desktop.md. Nothing here passes or fails.
#include <QAction>
#include <QComboBox>
#include <QDir>
#include <QFile>
#include <QFileDialog>
#include <QFileInfo>
#include <QLineEdit>
#include <QMessageBox>
#include <QPushButton>
#include <QTabWidget>
#include <QTemporaryDir>
#include <QTest>
#include <cstdio>
#include <functional>

#include "answers.h"
#include "gui_tests.h"
#include "heartbeat.h"
#include "plenoflame/lightfield/export.h"
#include "widgets/controls/side_panel.h"
#include "widgets/image/image_panel.h"
#include "widgets/image/image_view.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/window/main_window.h"

namespace plenoflame::desktop::test {
namespace {

constexpr int kLong = 900000;  ///< [ms] for the slowest export of the largest camera

}  // namespace

int survey(const char* scene) {
  QTemporaryDir folder;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  Answers answers;
  MainWindow window(
      std::make_unique<QSettings>(folder.filePath("settings.ini"), QSettings::IniFormat), {});
  window.set_unattended(true);
  window.resize(1500, 900);
  window.show();
  if (!window.open(scene)) return 1;
  Session& session = window.session();
  Heartbeat heart;
  const auto report = [&](const QString& what) {
    std::printf("%-44s %s\n", qPrintable(what), heart.take().c_str());
  };
  const auto rest = [&] {
    until([&] { return window.is_settled(); }, kLong);
    QTest::qWait(300);
  };
  const auto step = [&](const QString& what, const std::function<void()>& act) {
    heart.take();
    act();
    rest();
    report(what);
  };
  rest();
  until([&] { return session.light_field().views() != nullptr; }, kLong);
  QTest::qWait(1000);
  step("nothing", [] { QTest::qWait(1000); });
  for (QAction* group : window.side_panel().groups())
    step("panel " + group->text(), [&] { group->setChecked(true); });
  for (const Qt::Key key : {Qt::Key_2, Qt::Key_3, Qt::Key_4, Qt::Key_5, Qt::Key_1})
    step(QString("part Ctrl+%1").arg(static_cast<int>(key) - Qt::Key_0), [&] {
      QApplication::setActiveWindow(&window);
      QTest::keyClick(&window, key, Qt::ControlModifier);
    });
  ImageView& view = window.image_panel().view();
  step("Shift+click on the image",
       [&] { QTest::mouseClick(&view, Qt::LeftButton, Qt::ShiftModifier, view.rect().center()); });
  step("click on the image", [&] {
    QTest::mouseClick(&view, Qt::LeftButton, {}, view.rect().center() + QPoint(20, 10));
  });
  step("section from above", [&] {
    for (QAction* action : window.findChildren<QAction*>())
      if (action->text() == "Section seen from above") action->trigger();
  });
  step("outlines", [&] { window.image_panel().outlines_action()->trigger(); });
  step("one to one", [&] { QTest::keyClick(&view, Qt::Key_1); });
  for (const char* box : {"quantity", "scale", "map"})
    step(QString("image: ") + box, [&] {
      auto* combo = window.findChild<QComboBox*>(box);
      combo->setCurrentIndex(combo->count() - 1);
    });
  step("measure", [&] { window.findChild<QAction*>("measure")->trigger(); });
  for (const char* text : {"dark", "light"})
    step(text, [&] { window.findChild<QAction*>("actionDark")->trigger(); });
  for (int tab = 1; tab < 4; ++tab)
    step("tab " + window.light_field_panel().tabs().tabText(tab),
         [&] { window.light_field_panel().tabs().setCurrentIndex(tab); });
  window.light_field_panel().show_tab(LightFieldPanel::Tab::refocus);
  step("total focus", [&] {
    const auto before = session.light_field().stack();
    QTest::mouseClick(window.findChild<QPushButton*>("totalFocus"), Qt::LeftButton);
    until([&] { return session.light_field().stack() != before; }, kLong);
  });
  step("Keyboard", [&] {
    answers.when_shown<QMessageBox>(
        [](QMessageBox& box) { QTest::keyClick(&box, Qt::Key_Escape); });
    window.findChild<QAction*>("actionKeys")->trigger();
  });
  const auto named = [&](const QString& path) {
    answers.when_shown<QFileDialog>([path, &heart, &report](QFileDialog& dialog) {
      report("    its dialog");
      dialog.findChild<QLineEdit*>("fileNameEdit")->setText(path);
      QTest::keyClick(dialog.findChild<QLineEdit*>("fileNameEdit"), Qt::Key_Return);
    });
  };
  const auto export_to = [&](const QString& what, QAction* action, const QString& path) {
    QElapsedTimer since;
    since.start();
    step("export " + what, [&] {
      named(path);
      action->trigger();
    });
    std::printf("    %.1f s: %s\n", 1e-3 * static_cast<double>(since.elapsed()),
                qPrintable(window.last_message()));
  };
  const QString raw = folder.filePath("raw.exr");
  export_to("raw.exr", window.findChild<QAction*>("exportImage"), raw);
  export_to("raw.png", window.findChild<QAction*>("exportImage"), folder.filePath("raw.png"));
  export_to("rays.csv", window.findChild<QAction*>("exportRaysAction"),
            folder.filePath("rays.csv"));
  export_to("scene.png", window.findChild<QAction*>("exportScenePicture"),
            folder.filePath("scene.png"));
  export_to("derived.exr", window.findChild<QAction*>("exportDerivedAction"),
            folder.filePath("derived.exr"));
  QDir(folder.path()).mkdir("views");
  export_to("views", window.findChild<QAction*>("exportViews"), folder.filePath("views"));
  for (const ExportName& format : export_formats())
    for (QAction* action : window.findChildren<QAction*>()) {
      if (action->text() != QString(format.name) + "...") continue;
      QDir(folder.path()).mkdir(format.name);
      const QString path = folder.filePath(format.name);
      try {
        check_export(session.compiler().compiled()->camera, format.format);
      } catch (const std::exception&) {
        continue;
      }
      export_to(format.name, action, path);
    }
  step("save", [&] { session.document().save(folder.filePath("scene.toml").toStdString()); });
  step("open raw.exr", [&] { window.open(raw); });
  step("open scene.toml", [&] { window.open(folder.filePath("scene.toml")); });
  return 0;
}

}  // namespace plenoflame::desktop::test

// Keys, menus, themes, help: what one expects of any window.
#include <malloc.h>

#include <QAbstractButton>
#include <QComboBox>
#include <QLabel>
#include <QMessageBox>
#include <QSlider>
#include <QSpinBox>
#include <QStackedWidget>
#include <QTableWidget>
#include <QTreeView>
#include <algorithm>
#include <array>
#include <cmath>

#include "gui_tests.h"
#include "plenoflame/scene/presets.h"
#include "widgets/panels/render_panel.h"
#include "widgets/panels/scene_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/window/help_window.h"
#include "window_fixture.h"

using namespace plenoflame;
using namespace plenoflame::desktop;
using plenoflame::desktop::test::difference;

class MannersTest : public test::WindowFixture {
  Q_OBJECT

  void open_small() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
  }
  /// Clicks through the context menu of a line of the scene's tree.
  bool click_context(const char* path, const QStringList& texts) {
    ScenePanel& panel = window_->scene_panel();
    panel.reveal(path);
    QTest::qWait(30);
    QTreeView& tree = panel.tree();
    const QPoint at = tree.visualRect(tree.currentIndex()).center();
    bool clicked = false;
    when_shown<QMenu>([&](QMenu& menu) { clicked = test::click_through(menu, texts); });
    QContextMenuEvent event(QContextMenuEvent::Mouse, at, tree.viewport()->mapToGlobal(at));
    QApplication::sendEvent(tree.viewport(), &event);
    return answers_.end() && clicked;
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void renderingObeysItsKeys() {
    for (const char* name : {"renderStart", "renderFiner", "renderCoarser"})
      QVERIFY(!child<QWidget>(name)->isEnabled());  // there is nothing to render
    QVERIFY(!child<QWidget>("welcomeBack")->isVisible());
    open_small();
    QVERIFY(child<QWidget>("renderStart")->isEnabled());
    session().document().set_value("render.samples", "20000");
    RenderJob& job = session().render();
    QVERIFY(until([&] { return job.state() == RenderJob::State::running; }));
    press(Qt::Key_F6);
    QVERIFY(job.state() == RenderJob::State::paused);
    press(Qt::Key_F6);
    QVERIFY(job.state() == RenderJob::State::running);
    press(Qt::Key_F5, Qt::ShiftModifier);
    QVERIFY(job.state() == RenderJob::State::idle);
    press(Qt::Key_F5);
    QVERIFY(job.state() == RenderJob::State::running);
    QTest::mouseClick(child<QWidget>("renderStop"), Qt::LeftButton);
    // Without following changes nothing starts by itself; the button does it.
    QTest::mouseClick(child<QAbstractButton>("renderAutomatic"), Qt::LeftButton, {}, QPoint(8, 8));
    QVERIFY(!session().auto_render());
    session().document().set_value("render.samples", "16");
    QTest::qWait(200);
    QVERIFY(job.state() == RenderJob::State::idle);
    QTest::mouseClick(child<QAbstractButton>("renderStart"), Qt::LeftButton);
    QVERIFY(until([&] { return job.state() == RenderJob::State::finished; }));
    QVERIFY(job.curve().size() >= 2);
    QVERIFY(child<QLabel>("renderError")->text().contains('%'));
  }

  void presetsItemsAndDefaultsComeFromTheContextMenu() {
    open_small();
    Document& document = session().document();
    const Scene first = document.scene();
    QVERIFY(click_context(
        "camera.lens",
        {"Start from a preset", QString::fromStdString(preset_names(PresetKind::lens).front())}));
    QVERIFY(document.scene().camera.lens != first.camera.lens);
    press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(document.scene() == first);
    const QString flame = QString::fromStdString(preset_names(PresetKind::flame).back());
    QVERIFY(click_context("flames", {"Start from a preset", flame}));
    QCOMPARE(document.scene().flames.size(), std::size_t(2));
    QVERIFY(click_context("flames[1]", {"Remove this item"}));
    QCOMPARE(document.scene().flames.size(), std::size_t(1));
    QVERIFY(click_context("flames", {"Add an item"}));
    QCOMPARE(document.scene().flames.size(), std::size_t(2));
    for (int i = 0; i < 3; ++i) press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(document.scene() == first);
    QVERIFY(click_context("render.samples", {"Back to the default"}));
    QVERIFY(document.scene().render.samples != 0);
    const auto names = preset_names(PresetKind::camera);
    QVERIFY(click_context("camera", {"Start from a preset", QString::fromStdString(names.back())}));
    QVERIFY(!(document.scene().camera == first.camera));
  }

  void themeChangesEverywhereAndBack() {
    open_small();
    const auto drawn = [&] {
      const bool still = settled();
      window_->scene_view().picture();
      return still ? window_->side_panel().grab().toImage() : QImage();
    };
    const auto lightness = [](const QImage& image) {
      double sum = 0;
      for (int y = 0; y < image.height(); y += 3)
        for (int x = 0; x < image.width(); x += 3) sum += QColor(image.pixel(x, y)).lightnessF();
      return sum * 9 / (image.width() * image.height());
    };
    const QImage light = drawn();
    QVERIFY(click_menu({"View", "Dark theme"}));
    const QImage dark = drawn();
    // Both views are dark in both themes: the side panel tells them apart.
    QVERIFY(lightness(light) > 0.6 && lightness(dark) < 0.35);
    QVERIFY(lightness(window_->scene_view().picture()) < 0.4);
    // Text stands out from what it is on.
    const QPalette palette = window_->palette();
    QVERIFY(palette.color(QPalette::Text).lightness() - palette.color(QPalette::Base).lightness() >
            120);
    QVERIFY(click_menu({"View", "Dark theme"}));
    QVERIFY(difference(light, drawn()) < 0.01);
  }

  // Fusion draws a shadow under what is greyed, which made it look bolder than the rest.
  void greyedEntriesLookThinnerThanOthers() {
    open_small();
    for (int theme = 0; theme < 2; ++theme) {
      QVERIFY(click_menu({"View", "Dark theme"}));
      auto* const action = child<QAction>("actionMeasured");
      QMenu menu(window_.get());
      menu.addAction(action);
      menu.popup(window_->mapToGlobal(QPoint(20, 20)));
      QTest::qWait(50);
      // How much a drawing of the entry differs from its ground.
      const auto ink = [&] {
        const QImage drawn = menu.grab(menu.actionGeometry(action)).toImage();
        const int ground = drawn.pixelColor(drawn.width() - 6, drawn.height() / 2).lightness();
        double sum = 0;
        for (int y = 4; y < drawn.height() - 4; ++y)
          for (int x = 4; x < drawn.width() - 4; ++x)
            sum += std::abs(drawn.pixelColor(x, y).lightness() - ground);
        return sum;
      };
      action->setEnabled(false);
      const double grey = ink();
      action->setEnabled(true);
      const double active = ink();
      action->setEnabled(false);
      menu.close();
      QVERIFY2(grey > 0.2 * active && grey < 0.75 * active,
               qPrintable(QString("%1 %2").arg(grey).arg(active)));
    }
  }

  void helpIsAboutWhatHasTheFocus() {
    open_small();
    const auto page = [&](QWidget* focus) {
      QApplication::setActiveWindow(window_.get());
      focus->setFocus();
      press(Qt::Key_F1);
      auto* help = window_->findChild<HelpWindow*>();
      return help && help->isVisible() ? help->page() : QString();
    };
    QCOMPARE(page(&image()), QString("desktop.md"));
    QCOMPARE(page(&window_->scene_panel().tree()), QString("scene.md"));
    raise("raysGroup");
    QCOMPARE(page(child<QTableWidget>("raysTable")), QString("rays.md"));
    raise("designGroup");
    QCOMPARE(page(child<QTableWidget>("designTable")), QString("design.md"));
    raise("flameGroup");
    QCOMPARE(page(child<QWidget>("flameGenerate")), QString("flames.md"));
    show_tab(LightFieldPanel::Tab::views);
    QCOMPARE(page(child<QWidget>("exportDerived")), QString("light-fields.md"));
  }

  void aboutBoxNamesTheVersions() {
    QString text;
    when_shown<QMessageBox>([&](QMessageBox& box) {
      text = box.text();
      QTest::keyClick(&box, Qt::Key_Escape);
    });
    QVERIFY(click_menu({"Help", "About Plenoflame"}));
    const QString version = run(PLENOFLAME_COMMAND, {"--version"}).trimmed().section(' ', 1, 1);
    QVERIFY2(!version.isEmpty() && text.contains(version), qPrintable(text + " / " + version));
    QVERIFY(text.contains(qVersion()));
    QVERIFY(text.contains("VTK 9."));
    when_shown<QMessageBox>([&](QMessageBox& box) {
      text = box.text();
      QTest::keyClick(&box, Qt::Key_Escape);
    });
    press(Qt::Key_F1, Qt::ShiftModifier);
    QVERIFY(text.contains("F6"));
  }

  void questionOfUnsavedChangesIsAnsweredByKeys() {
    open_small();
    type("render.samples", "3");
    window_->set_unattended(false);
    QStringList texts;
    when_shown<QMessageBox>([&](QMessageBox& box) {
      for (const QAbstractButton* button : box.buttons()) texts << button->text();
      QApplication::setActiveWindow(&box);  // as a window manager does
      QTest::keyClick(&box, Qt::Key_C, Qt::AltModifier);
    });
    press(Qt::Key_N, Qt::ControlModifier);
    window_->set_unattended(true);
    QCOMPARE(texts.size(), 3);
    for (const QString& text : texts) QVERIFY2(text.contains('&'), qPrintable(text));
    QVERIFY(session().document().is_modified());
  }

  void everyControlSaysWhatItIs() {
    open_small();
    QStringList silent;
    for (QWidget* view : std::initializer_list<QWidget*>{
             &window_->side_panel(), &window_->scene_view(), &window_->light_field_panel()})
      for (QWidget* widget : view->findChildren<QWidget*>()) {
        const bool control = qobject_cast<QComboBox*>(widget) || qobject_cast<QSlider*>(widget) ||
                             qobject_cast<QAbstractSpinBox*>(widget) ||
                             qobject_cast<QAbstractButton*>(widget) ||
                             qobject_cast<QLineEdit*>(widget);
        const QWidget* const parent = widget->parentWidget();
        const bool part = qobject_cast<const QAbstractSpinBox*>(parent) ||
                          qobject_cast<const QComboBox*>(parent) || parent->inherits("QTabBar") ||
                          parent->inherits("QAbstractItemView");
        if (!control || part || !widget->toolTip().isEmpty()) continue;
        if (widget->inherits("QTableCornerButton")) continue;
        silent << view->objectName() + "/" + widget->metaObject()->className() + " " +
                      widget->objectName();
      }
    QVERIFY2(silent.isEmpty(), qPrintable(silent.join("; ")));
  }

  void manyEditsTakeNoMemory() {
    open_small();
    session().document().set_value("render.samples", "2");  // pictures as large, but made quickly
    QVERIFY(settled());
    ScenePanel& panel = window_->scene_panel();
    panel.reveal("camera.focus.object_distance");
    auto* slider = child<QSlider>("parameterSlider");
    const auto edit = [&](int count) {  // to and fro, so that the scene is the same in the end
      for (int i = 0; i < count; ++i) {
        QTest::keyClick(slider, i % 4 < 2 ? Qt::Key_PageUp : Qt::Key_PageDown);
        QTest::qWait(5);
        if (i % 8 == 7) QVERIFY(settled());  // its picture is made, too
      }
    };
    const auto held = [] {
      const struct mallinfo2 heap = mallinfo2();
      return static_cast<double>(heap.uordblks) + static_cast<double>(heap.hblkhd);
    };
    // The memory at rest, once nothing is being made any more (a design is traced for seconds, with
    // tables of megabytes): the same for a second.
    const auto at_rest = [&] {
      until([&] { return session().at_rest(); });
      double last = held();
      for (int i = 0, same = 0; i < 200 && same < 10; ++i) {
        QTest::qWait(100);
        same = std::fabs(held() - last) < 1e5 ? same + 1 : 0;
        last = held();
      }
      return last;
    };
    edit(40);
    // The memory at rest may differ by what waits to be used again (2 MB now and then): a leak
    // raises the least that is held. One scene has several kilobytes, its picture hundreds.
    constexpr int kEdits = 48;
    std::array<double, 6> helds{};
    for (double& h : helds) {
      if (&h != helds.data()) edit(kEdits);
      h = at_rest();
    }
    const auto middle = helds.begin() + helds.size() / 2;
    const double rise =
        (*std::min_element(middle, helds.end()) - *std::min_element(helds.begin(), middle)) /
        (kEdits * static_cast<double>(helds.size() / 2));
    qInfo("%.1f bytes per edit", rise);
    QVERIFY2(rise < 4000, qPrintable(QString::number(rise)));
  }

  void tableOfTheParametersHasUnitsRangesAndMeanings() {
    open_small();
    QTreeView& tree = window_->scene_panel().tree();
    window_->scene_panel().reveal("camera.sensor.pixel_pitch");
    const QModelIndex index = tree.currentIndex();
    QVERIFY(index.data().toString().contains("um"));
    QVERIFY(!index.data(Qt::ToolTipRole).toString().isEmpty());
    QVERIFY(!index.siblingAtColumn(ParameterModel::kAllowed).data().toString().isEmpty());
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_manners_test() {
  return std::make_unique<MannersTest>();
}

#include "manners_test.moc"

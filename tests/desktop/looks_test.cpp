// The drawing of the flame, and its viewpoint; the section's parts; bars of colours;
// one view alone. References: where points of the world are seen, the values of
// the image, the design's own lines.
#include <QAction>
#include <QCheckBox>
#include <QClipboard>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QDockWidget>
#include <QLabel>
#include <QScrollBar>
#include <QSpinBox>
#include <QTableWidget>
#include <QToolButton>

#include "gui_tests.h"
#include "scene_fixture.h"
#include "widgets/controls/plot_widget.h"
#include "widgets/image/colour_bar.h"
#include "widgets/window/lens_window.h"
#include "widgets/window/preferences_dialog.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class LooksTest : public test::SceneFixture {
  Q_OBJECT

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void barBesideTheImageHasItsValues() {
    QVERIFY(open_example("lenslets-30"));
    auto* bar = child<ColourBar>("imageBar");
    QVERIFY(bar->isVisible());
    QCOMPARE(bar->labels().front().section(' ', 0, 0), QString("0"));
    auto* white = child<QLineEdit>("white");
    white->setFocus();
    QTest::keyClicks(white, "20 nW");
    QTest::keyClick(white, Qt::Key_Return);
    QCOMPARE(bar->labels().back(), QString("20 nW"));
    QVERIFY(bar->labels()[2].endsWith("W"));
  }

  void oneViewIsShownAlone() {
    QVERIFY(open_example("lenslets-30"));
    image().setFocus();
    QVERIFY(until([&] { return image().hasFocus(); }));
    const int before = image().height();
    press(Qt::Key_F11);
    QVERIFY(until([&] { return !section().isVisible() && !scene3d()->isVisible(); }));
    QVERIFY(!child<QDockWidget>("sceneDock")->isVisible());
    QVERIFY(until([&] { return image().height() > before; }));
    press(Qt::Key_F11);
    QVERIFY(until([&] { return section().isVisible() && scene3d()->isVisible(); }));
    QVERIFY(child<QDockWidget>("sceneDock")->isVisible());
    child<QDockWidget>("sceneDock")->close();
    QVERIFY(click_menu({"View", "Reset layout"}));
    QVERIFY(until([&] { return child<QDockWidget>("sceneDock")->isVisible(); }));
    QApplication::clipboard()->clear();
    QVERIFY(click_menu({"Edit", "Copy picture"}));
    QVERIFY(!QApplication::clipboard()->image().isNull());
    press(Qt::Key_N, Qt::ControlModifier);
    QVERIFY(settled());
    QCOMPARE(session().document().camera().sensor.columns, 600);
    QVERIFY(session().document().file().empty());
  }

  void designHasColumnsAndFoldsItsWarnings() {
    QVERIFY(open_example("lenslets-30"));
    raise("designDock");
    QVERIFY(until(
        [&] { return session().design().result() && session().design().result()->complete; }));
    auto* table = child<QTableWidget>("designTable");
    QCOMPARE(table->columnCount(), 3);
    for (int row = 0; row < table->rowCount(); ++row) {
      const QString value = table->item(row, 1)->text().section('\n', 0, 0);
      QVERIFY(!value.contains(", ") && !value.contains("; "));
      const QString whole = QString::fromStdString(
          session().design().result()->lines[static_cast<std::size_t>(row)].second);
      QVERIFY(whole.startsWith(value));
      QVERIFY(whole.endsWith(table->item(row, 2)->text()));
    }
    // Nothing is cut: a narrow panel has the remarks below their values, a wide one beside them.
    auto* const dock = child<QDockWidget>("designDock");
    const auto all_seen = [&] {
      for (int row = 0; row < table->rowCount(); ++row) {
        const QRect needed =
            table->fontMetrics().boundingRect(QRect(0, 0, table->columnWidth(1) - 4, 10000),
                                              Qt::TextWordWrap, table->item(row, 1)->text());
        if (table->rowHeight(row) < needed.height()) return false;
      }
      return true;
    };
    for (const int width : {300, 900}) {
      window_->resizeDocks({dock}, {width}, Qt::Horizontal);
      QVERIFY(until([&] { return std::abs(dock->width() - width) < 60; }));
      const bool narrow = width < 500;
      QVERIFY(until([&] { return table->isColumnHidden(2) == narrow; }));
      QVERIFY(until([&] { return table->horizontalScrollBar()->maximum() == 0; }));
      for (int row = 0; row < table->rowCount(); ++row) {
        const QString remark = table->item(row, 2)->text(), shown = table->item(row, 1)->text();
        if (!remark.isEmpty()) QCOMPARE(shown.endsWith("\n" + remark), narrow);
      }
      QVERIFY(until(all_seen));
    }
    // Many warnings are folded at first.
    auto* fold = child<QToolButton>("designWarningsFold");
    const int count = session().design().result()->warnings.size();
    QVERIFY(count > 2 && fold->text().contains(QString::number(count)));
    QVERIFY(!child<QLabel>("designWarnings")->isVisible());
    QTest::mouseClick(fold, Qt::LeftButton);
    QVERIFY(child<QLabel>("designWarnings")->isVisible());
  }

  void flameIsBrighterThanWhatIsAroundItInBothThemes() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_2));
    for (const bool dark : {false, true}) {
      child<QAction>("actionDark")->setChecked(dark);
      const QImage picture = view().picture();
      const int background = qGray(picture.pixel(picture.width() / 8, picture.height() / 2));
      QVERIFY(background < 50);
      const Box box = scene().medium->bounds();
      const QPointF at = view().to_widget(0.5 * (box.lower + box.upper));
      const double ratio = scene3d()->devicePixelRatioF();
      const int flame = qGray(picture.pixel((at * ratio).toPoint()));
      QVERIFY2(flame > background + 70, qPrintable(QString("%1, %2").arg(flame).arg(background)));
    }
    // Colours span what shines: the inner layer of 1200 K is cold beside the others, and emits
    // little (absorption times T^4); the hottest layer is that of the scene file.
    const auto [cold, hot] = view().flame_temperatures();
    double hottest = 0;
    for (const EllipsoidSpec& layer : session().document().scene().flames[0].layers)
      hottest = std::max(hottest, layer.temperature);
    QVERIFY(std::abs(hot / hottest - 1) < 1e-3);
    QVERIFY(cold > 1300);
  }

  void flameIsCutAndDrawnInThreeWays() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_2));
    QTest::mouseClick(child<QToolButton>("alongZ"), Qt::LeftButton);
    const QImage whole = view().picture();
    auto* const drawing = child<QComboBox>("flameDrawing");
    auto* const cut = child<QComboBox>("flameCut");
    drawing->setFocus();
    for (const char* way : {"absorption", "surfaces"}) {
      QTest::keyClick(drawing, Qt::Key_Down);
      QVERIFY2(test::difference(whole, view().picture()) > 1e-3, way);
    }
    press(Qt::Key_Z, Qt::ControlModifier);
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(drawing->currentIndex(), 0);
    // Cut across y at the middle: one side of the picture is as before, the other has no flame.
    cut->setFocus();
    QTest::keyClick(cut, Qt::Key_Down);
    QTest::keyClick(cut, Qt::Key_Down);
    QCOMPARE(cut->currentText(), QString("Cut y"));
    const QImage half = view().picture();
    const Box box = scene().medium->bounds();
    const double ratio = scene3d()->devicePixelRatioF();
    const auto grey = [&](const QImage& picture, double share) {
      Vec3 place = 0.5 * (box.lower + box.upper);
      place.y = box.lower.y + share * (box.upper.y - box.lower.y);
      return qGray(picture.pixel((view().to_widget(place) * ratio).toPoint()));
    };
    QVERIFY(std::abs(grey(half, 0.3) - grey(whole, 0.3)) < 25);
    QVERIFY2(grey(half, 0.7) < 50 && grey(whole, 0.7) > 60,
             qPrintable(QString("%1, %2").arg(grey(half, 0.7)).arg(grey(whole, 0.7))));
  }

  void sectionFollowsTheParts() {
    QVERIFY(open_example("lenslets-30"));
    const auto height_of_view = [&] {  // [m] from the upper to the lower edge
      return section().height() /
             std::abs(section().to_widget(0, 0).y() - section().to_widget(0, 1).y());
    };
    double before = 1e9;
    for (const char* name : {"viewScene", "viewFlame", "viewArray", "viewPixel"}) {
      auto* const action = child<QAction>(name);
      QWidget* button = nullptr;
      for (auto* candidate : window_->findChildren<QToolButton*>())
        if (candidate->defaultAction() == action) button = candidate;
      QVERIFY(button);
      QTest::mouseClick(button, Qt::LeftButton);
      QVERIFY2(height_of_view() < before, name);
      before = height_of_view();
    }
    const double pitch = session().document().camera().array.pitch;
    QVERIFY(before < 4 * pitch && before > pitch);
  }

  void lensDataCanBeTypedAndDiagramsFollow() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(click_menu({"View", "Main lens", "Lens data..."}));
    auto* const table = child<QTableWidget>("lensTable");
    QVERIFY(table);
    const auto& surfaces = session().document().camera().lens.surfaces;
    QCOMPARE(table->rowCount(), static_cast<int>(surfaces.size()));
    // A radius twice as long: less power. The lens maker's formula says how much.
    const auto power = [&] {
      const QString text = child<QLabel>("lensFigures")->text();
      return 1 / parse_quantity(text.section(' ', 2, 3).section(',', 0, 0).toStdString(),
                                Dimension::length);
    };
    const double before = power(), radius = surfaces[0].radius;
    const double index = surfaces[0].glass.empty() ? surfaces[0].index : 0;
    table->setCurrentCell(0, 0);
    table->editItem(table->item(0, 0));
    auto* const editor = table->findChild<QLineEdit*>();
    QVERIFY(editor);
    editor->selectAll();
    QTest::keyClicks(editor, QString("%1 mm").arg(2e3 * radius, 0, 'g', 10));
    QTest::keyClick(editor, Qt::Key_Return);
    QVERIFY(until([&] {
      return std::abs(session().document().camera().lens.surfaces[0].radius / radius - 2) < 1e-6;
    }));
    QVERIFY(power() < before);
    if (index > 1) {
      // Thin lens: (n - 1) / R of the first surface goes down by half; its thickness changes that
      // by some per cent.
      const double lost = (index - 1) * 0.5 / radius;
      QVERIFY(std::abs((before - power()) / lost - 1) < 0.1);
    }
    child<LensTable>("lensTableWindow")->close();
    press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(until([this] { return !child<LensTable>("lensTableWindow"); }));
    for (QAction* action : window_->findChildren<QAction*>())
      if (action->text() == "MTF...") action->trigger();
    auto* const window = child<LensDiagrams>("mtfWindow");
    QVERIFY(until([&] { return window->plots()[0]->series().size() == 3; }));
    const auto& curve = window->plots()[0]->series()[1].points;
    QVERIFY(std::abs(curve.front().y() - 1) < 1e-12);
    QVERIFY(curve.back().y() < 1);
  }

  void preferencesHoldAtOnceAndAreKept() {
    const int before = QApplication::font().pointSize();
    when_shown<PreferencesDialog>([](PreferencesDialog& dialog) {
      auto* const size = dialog.findChild<QSpinBox*>("preferencesFont");
      size->selectAll();
      QTest::keyClicks(size, "16");
      QTest::keyClick(size, Qt::Key_Tab);
      QTest::mouseClick(dialog.findChild<QCheckBox*>("preferencesDark"), Qt::LeftButton, {},
                        QPoint(8, 8));
      QTest::mouseClick(dialog.findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Ok),
                        Qt::LeftButton);
    });
    QVERIFY(click_menu({"Edit", "Preferences..."}));
    QCOMPARE(QApplication::font().pointSize(), 16);
    QVERIFY(child<QAction>("actionDark")->isChecked());
    QCOMPARE(settings()->value("window/font").toInt(), 16);
    QFont font = QApplication::font();
    font.setPointSize(before);
    QApplication::setFont(font);
    child<QAction>("actionDark")->setChecked(false);
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_looks_test() {
  return std::make_unique<LooksTest>();
}

#include "looks_test.moc"

// How the flame is drawn, and from where; the section's parts; bars of colours;
// one view alone. References: where points of the world are seen, the values of
// the image, the design's own lines.
#include <QClipboard>
#include <QDockWidget>
#include <QLabel>
#include <QTableWidget>
#include <QToolButton>

#include "gui_tests.h"
#include "scene_fixture.h"
#include "widgets/colour_bar.h"

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
      QVERIFY(!table->item(row, 1)->text().contains(", "));
      const QString whole = QString::fromStdString(
          session().design().result()->lines[static_cast<std::size_t>(row)].second);
      QVERIFY(whole.startsWith(table->item(row, 1)->text()));
      QVERIFY(whole.endsWith(table->item(row, 2)->text()));
    }
    // Many warnings are folded at first.
    auto* fold = child<QToolButton>("designWarningsFold");
    const int count = session().design().result()->warnings.size();
    QVERIFY(count > 2 && fold->text().contains(QString::number(count)));
    QVERIFY(!child<QLabel>("designWarnings")->isVisible());
    QTest::mouseClick(fold, Qt::LeftButton);
    QVERIFY(child<QLabel>("designWarnings")->isVisible());
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_looks_test() {
  return std::make_unique<LooksTest>();
}

#include "looks_test.moc"

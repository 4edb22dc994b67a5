// The drawing of the flame, and its viewpoint; the section's parts; bars of colours;
// one view alone. References: where points of the world are seen, the values of
// the image, the design's own lines.
#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor2D.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkPropCollection.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkTextActor.h>

#include <QAction>
#include <QCheckBox>
#include <QClipboard>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QHeaderView>
#include <QLabel>
#include <QScrollBar>
#include <QSlider>
#include <QSpinBox>
#include <QSplitter>
#include <QTableWidget>
#include <QToolButton>
#include <QTreeView>

#include "gui_tests.h"
#include "plenoflame/base/units.h"
#include "scene_fixture.h"
#include "widgets/controls/plot_widget.h"
#include "widgets/window/lens_window.h"
#include "widgets/window/preferences_dialog.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class LooksTest : public test::SceneFixture {
  Q_OBJECT

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void oneViewIsShownAlone() {
    QVERIFY(open_example("lenslets-30"));
    image().setFocus();
    QVERIFY(until([&] { return image().hasFocus(); }));
    const int before = image().height();
    press(Qt::Key_F11);
    QVERIFY(until([&] { return !view().isVisible(); }));
    QVERIFY(!window_->side_panel().isVisible());
    QVERIFY(until([&] { return image().height() > before; }));
    press(Qt::Key_F11);
    QVERIFY(until([&] { return scene3d()->isVisible(); }));
    QVERIFY(section().isVisible() && !child<QWidget>("scene3d")->isVisible());
    QVERIFY(window_->scene_panel().isVisible());
    QTest::mouseClick(child<QToolButton>("sceneGroupTitle"), Qt::LeftButton);
    QVERIFY(!window_->scene_panel().isVisible());
    press(Qt::Key_F9);
    QVERIFY(!window_->side_panel().isVisible());
    QVERIFY(click_menu({"View", "Reset layout"}));
    QVERIFY(until([&] { return window_->scene_panel().isVisible(); }));
    QVERIFY(child<QWidget>("scene3d")->isVisible());
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
    raise("designGroup");
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
    auto* const split = child<QSplitter>("workspace");
    const auto all_seen = [&] {
      for (int row = 0; row < table->rowCount(); ++row) {
        const QRect needed =
            table->fontMetrics().boundingRect(QRect(0, 0, table->columnWidth(1) - 4, 10000),
                                              Qt::TextWordWrap, table->item(row, 1)->text());
        if (table->rowHeight(row) < needed.height()) return false;
      }
      return true;
    };
    for (const int width : {0, 300, 900}) {  // 0: as wide as it is
      if (width == 900) window_->resize(2000, 900);
      if (width > 0) split->setSizes({width, 1000 - width / 2, 1000 - width / 2});
      const SidePanel& side = window_->side_panel();
      QVERIFY(until([&] { return width == 0 || std::abs(side.width() - width) < 60; }));
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

  void windowsOfEachSizeHoldTheirTablesAndPanels() {
    // A window as the program makes it, with no settings from before.
    MainWindow fresh(std::make_unique<QSettings>(file("none.ini"), QSettings::IniFormat), {});
    fresh.set_unattended(true);
    fresh.show();
    QVERIFY(QTest::qWaitForWindowExposed(&fresh));
    QVERIFY(fresh.open_example("lenslets-30"));
    QVERIFY(until([&] { return fresh.is_settled(); }));
    // One of its rays ends at a surface, which is a long text.
    fresh.session().document().select(Selection::of_pixel(149, 150));
    QVERIFY(until([&] { return fresh.session().rays().rays() != nullptr; }));
    auto* const rays = fresh.findChild<QTableWidget*>("raysTable");
    auto* const left_out = fresh.findChild<QLabel*>("renderLeftOut");
    for (const QSize size : {QSize(1600, 1000), QSize(1366, 768), QSize(1280, 720)}) {
      fresh.resize(size);
      QVERIFY(until([&] { return fresh.size() == size; }));
      // Two views share the window, each at least two fifths of it.
      for (const QWidget* view :
           std::initializer_list<const QWidget*>{&fresh.scene_view(), &fresh.light_field_panel()}) {
        QVERIFY2(until([&] { return 5 * view->width() >= 2 * size.width(); }, 5000),
                 qPrintable(QString("%1 of %2").arg(view->width()).arg(size.width())));
        QVERIFY(10 * view->height() >= 9 * size.height());
      }
      QCOMPARE(cut_tool(fresh, size, fresh.scene_view()), QString());
      QCOMPARE(cut_tool(fresh, size, fresh.image_panel(), {"shownPicture", "blinkPictures"}),
               QString());
      fresh.side_panel().set_opened({"renderGroup"});
      // The line of what was left out is seen in full.
      QVERIFY(left_out->text().contains("microlens") && !left_out->text().contains("..."));
      QVERIFY(!left_out->text().contains(QChar(0x2026)));
      const auto whole = [&] {
        fresh.side_panel().ensureWidgetVisible(left_out);  // a low window has it further down
        const QRect words = left_out->fontMetrics().boundingRect(
            QRect(0, 0, left_out->width(), 10000), Qt::TextWordWrap, left_out->text());
        return words.height() <= left_out->height() && words.width() <= left_out->width() &&
               left_out->visibleRegion().boundingRect() == left_out->rect();
      };
      if (size.width() >= 1366)
        QVERIFY2(until(whole, 10000), qPrintable(QString::number(size.width())));
      fresh.side_panel().set_opened({"sceneGroup"});
      const auto* const tree = fresh.findChild<QTreeView*>("sceneTree");
      QVERIFY(until([&] { return tree->isVisible() && tree->viewport()->width() < 400; }, 5000));
      QTest::qWait(100);
      QCOMPARE(tree->horizontalScrollBar()->maximum(), 0);
      fresh.side_panel().set_opened({"raysGroup"});
      for (const char* name : {"raysTable", "surfacesTable"}) {
        const auto* const table = fresh.findChild<QTableWidget*>(name);
        QVERIFY(table->rowCount() > 0);
        QVERIFY2(until([&] { return table->horizontalScrollBar()->maximum() == 0; }, 5000), name);
        const QHeaderView& header = *table->horizontalHeader();
        for (int i = 0; i < header.count(); ++i)
          QVERIFY2(header.isSectionHidden(i) || header.sectionSize(i) >= header.sectionSizeHint(i),
                   name);
        if (table == rays && size.width() >= 1366) QVERIFY(!header.isSectionHidden(7));  // radiance
        // The tooltip has the columns for which there is no room.
        QCOMPARE(table->item(0, 0)->toolTip().count('\n') + 1, table->columnCount());
      }
      // Ten rays are seen, each as high as its letters.
      const auto is_seen = [&](int row) {
        const QRect place = rays->visualItemRect(rays->item(row, 0));
        return rays->viewport()->rect().contains(place.adjusted(0, 0, -1, -1));
      };
      until([&] { return is_seen(9); }, 10000);
      QVERIFY2(is_seen(9), qPrintable(QString("%1 high").arg(rays->viewport()->height())));
      QVERIFY(rays->visualItemRect(rays->item(9, 0)).height() >= rays->fontMetrics().height());
    }
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

  void slidersThatMoveNothingAreGreyInBothThemes() {
    QVERIFY(open_example("lenslets-30"));
    auto* const cut = child<QComboBox>("flameCut");
    auto* const place = child<QSlider>("flameCutPlace");
    // The strongest colour that is seen of it, of 255.
    const auto colour = [&] {
      const QImage picture = place->grab().toImage();
      int most = 0;
      for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
          const QColor here(picture.pixel(x, y));
          const auto [least, largest] = std::minmax({here.red(), here.green(), here.blue()});
          most = std::max(most, largest - least);
        }
      return most;
    };
    for (const bool dark : {false, true}) {
      child<QAction>("actionDark")->setChecked(dark);
      cut->setFocus();
      QTest::keyClick(cut, Qt::Key_Down);
      QVERIFY2(until([&] { return colour() > 80; }, 2000), qPrintable(QString::number(colour())));
      QTest::keyClick(cut, Qt::Key_Up);
      QVERIFY2(until([&] { return colour() < 40; }, 2000), qPrintable(QString::number(colour())));
    }
  }

  void flameIsCutAndDrawnInFourWays() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_2));
    QTest::mouseClick(child<QToolButton>("alongZ"), Qt::LeftButton);
    const QImage whole = view().picture();
    auto* const drawing = child<QComboBox>("flameDrawing");
    auto* const cut = child<QComboBox>("flameCut");
    drawing->setFocus();
    for (const char* way : {"emission", "absorption", "surfaces"}) {
      QTest::keyClick(drawing, Qt::Key_Down);
      QVERIFY2(test::difference(whole, view().picture()) > 1e-3, way);
    }
    for (int i = 0; i < 3; ++i) press(Qt::Key_Z, Qt::ControlModifier);
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
    const auto height_of_view = [&] {  // [m] along the shorter side
      return std::min(section().width(), section().height()) /
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

  void sectionNamesItsParts() {
    QVERIFY(open_example("lenslets-30"));
    const Camera& camera = scene().camera;
    const double sensor = 0.5 * camera.spec().sensor.size().y;
    const Box box = scene().medium->bounds();
    // The names that each part of the section shows, by their place along the axis.
    struct Part {
      const char* button;
      QStringList names;
    };
    for (const Part& part :
         {Part{"viewScene", {"flame", "main lens", "sensor"}}, Part{"viewFlame", {"flame"}},
          Part{"viewCamera", {"main lens", "microlenses", "sensor"}},
          Part{"viewArray", {"microlenses", "sensor"}},
          Part{"viewPixel", {"microlenses", "sensor"}}}) {
      auto* const action = child<QAction>(part.button);
      for (auto* candidate : window_->findChildren<QToolButton*>())
        if (candidate->defaultAction() == action) QTest::mouseClick(candidate, Qt::LeftButton);
      QVERIFY(settled());
      section().grab();
      QStringList told;
      for (const auto& [name, place] : section().names()) {
        told << name;
        QVERIFY2(QRectF(section().rect()).contains(place), qPrintable(name));
        QVERIFY(place.width() >= section().fontMetrics().horizontalAdvance(name));
        for (const auto& [other, its] : section().names())
          QVERIFY2(other == name || !its.intersects(place), qPrintable(name + other));
        // No name crosses the line of the sensor, where it is as high as that.
        const QRectF line(section().to_widget(camera.sensor(), sensor),
                          section().to_widget(camera.sensor(), -sensor));
        const bool beside = place.right() < line.left() || place.left() > line.left();
        const bool above = place.bottom() < line.top() || place.top() > line.bottom();
        QVERIFY2(beside || above, qPrintable(QString(part.button) + ": " + name));
      }
      for (const QString& name : part.names)
        QVERIFY2(told.contains(name),
                 qPrintable(QString("%1: %2").arg(part.button, told.join(", "))));
      // Each is nearest to its own part, of those that stand apart on the screen.
      const auto along = [&](const QString& name) {
        return name == "flame"       ? section().to_widget(0.5 * (box.lower.x + box.upper.x), 0).x()
               : name == "main lens" ? section().to_widget(0, 0).x()
               : name == "sensor"    ? section().to_widget(camera.sensor(), 0).x()
                                     : section().to_widget(camera.array_front(), 0).x();
      };
      for (const auto& [name, place] : section().names()) {
        const double own = std::abs(place.center().x() - along(name));
        for (const QString& other : part.names)
          QVERIFY2(std::abs(along(other) - along(name)) < place.width() ||
                       own < std::abs(place.center().x() - along(other)),
                   qPrintable(QString("%1: %2, %3").arg(part.button, name, other)));
      }
    }
  }

  void cubeTellsWhereTheAxesPoint() {
    const auto corner = [this] {
      const QImage picture = view().picture();
      return picture.copy(picture.width() * 86 / 100, 0, picture.width() * 14 / 100,
                          picture.height() * 15 / 100);
    };
    // The letters of x are red, those of y green, those of z blue.
    const auto letters = [](const QImage& picture) {
      std::array<int, 3> count{};
      for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
          const QColor c(picture.pixel(x, y));
          const int r = c.red(), g = c.green(), b = c.blue();
          if (r > g + 40 && r > b + 40) ++count[0];
          if (g > r + 40 && g > b + 40) ++count[1];
          if (b > r + 40 && b > g + 20) ++count[2];
        }
      return count;
    };
    const auto none = letters(corner());  // an empty view has no cube
    QCOMPARE(none[0] + none[1] + none[2], 0);
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_2));
    std::size_t axis = 0;
    for (const char* name : {"alongX", "alongY", "alongZ"}) {
      std::array<QImage, 2> sides;  // the face with + and that with -
      for (QImage& side : sides) {
        QTest::mouseClick(child<QToolButton>(name), Qt::LeftButton);
        side = corner();
        const auto seen = letters(side);
        const int others = seen[0] + seen[1] + seen[2] - seen[axis];
        QVERIFY2(seen[axis] > 20 && others == 0,
                 qPrintable(QString("%1: %2 %3").arg(name).arg(seen[axis]).arg(others)));
      }
      // One side has a plus where the other one has a minus, which takes fewer pixels.
      QVERIFY2(letters(sides[0])[axis] > letters(sides[1])[axis], name);
      ++axis;
    }
    // Turned by the pointer it shows more than one face.
    const QPoint middle = scene3d()->rect().center();
    QTest::mousePress(scene3d(), Qt::LeftButton, {}, middle);
    for (int i = 1; i <= 10; ++i) QTest::mouseMove(scene3d(), middle + QPoint(8 * i, 8 * i));
    QTest::mouseRelease(scene3d(), Qt::LeftButton, {}, middle + QPoint(80, 80));
    const auto turned = letters(corner());
    QVERIFY2((turned[0] > 0) + (turned[1] > 0) + (turned[2] > 0) >= 2,
             qPrintable(QString("%1 %2 %3").arg(turned[0]).arg(turned[1]).arg(turned[2])));
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
    QApplication::setActiveWindow(window_.get());  // as a window manager would
    QVERIFY(click_menu({"View", "Main lens", "MTF..."}));
    auto* const window = child<LensDiagrams>("mtfWindow");
    QVERIFY(until([&] { return window->plots()[0]->series().size() == 3; }));
    const auto& curve = window->plots()[0]->series()[1].points;
    QVERIFY(std::abs(curve.front().y() - 1) < 1e-12);
    QVERIFY(curve.back().y() < 1);
  }

  void sceneIsSeenAlongEachAxisAndBesideAScale() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_2));
    const Box box = scene().medium->bounds();
    const Vec3 middle = 0.5 * (box.lower + box.upper);
    const double step = 0.1 * (box.upper.z - box.lower.z);
    // Right-handed axes: what points to the right and up in the view from the positive side.
    struct Seen {
      const char* button;
      Vec3 depth, right, up;
    };
    for (const Seen& seen : {Seen{"alongX", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                             Seen{"alongY", {0, 1, 0}, {-1, 0, 0}, {0, 0, 1}},
                             Seen{"alongZ", {0, 0, 1}, {1, 0, 0}, {0, 1, 0}}})
      for (const double side : {1.0, -1.0}) {  // a second click looks from the other side
        QTest::mouseClick(child<QToolButton>(seen.button), Qt::LeftButton);
        view().picture();
        const QPointF at = view().to_widget(middle);
        const auto way = [&](const Vec3& direction) {
          return view().to_widget(middle + step * direction) - at;
        };
        const double length = std::hypot(way(seen.up).x(), way(seen.up).y());
        QVERIFY2(-way(seen.up).y() > 0.99 * length, seen.button);
        QVERIFY2(side * way(seen.right).x() > 0.9 * length, seen.button);
        QVERIFY2(std::hypot(way(seen.depth).x(), way(seen.depth).y()) < 0.1 * length, seen.button);
        // The bar is as long as it says, in the plane through the middle.
        auto* const widget = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
        vtkPropCollection* const props =
            widget->renderWindow()->GetRenderers()->GetFirstRenderer()->GetViewProps();
        double says = 0, drawn = 0;  // [m], [pixel]
        for (int i = 0; i < props->GetNumberOfItems(); ++i) {
          vtkObject* const prop = props->GetItemAsObject(i);
          if (auto* const text = vtkTextActor::SafeDownCast(prop); text && text->GetVisibility())
            says = parse_quantity(text->GetInput(), Dimension::length);
          // Neither the texts, which are drawn as actors, too, nor the hidden line of Measure.
          auto* const line = vtkTextActor::SafeDownCast(prop) || !vtkProp::SafeDownCast(prop) ||
                                     !vtkProp::SafeDownCast(prop)->GetVisibility()
                                 ? nullptr
                                 : vtkActor2D::SafeDownCast(prop);
          auto* const mapper =
              line ? vtkPolyDataMapper2D::SafeDownCast(line->GetMapper()) : nullptr;
          if (mapper && mapper->GetInput()) {
            std::array<double, 6> bounds{};
            mapper->GetInput()->GetBounds(bounds.data());
            drawn = bounds[1] - bounds[0];
          }
        }
        QVERIFY2(says > 0 && std::abs(drawn / says / (length / step) - 1) < 0.03,
                 qPrintable(QString("%1 m, %2 pixels").arg(says).arg(drawn)));
        // It is a round length, the longest that is no more than a quarter of the width.
        const double power = std::pow(10.0, std::floor(std::log10(says) + 1e-9));
        const double digit = says / power, next = digit < 1.5 ? 2 : digit < 3 ? 2.5 : 2;
        QVERIFY2(std::abs(digit - 1) < 1e-9 || std::abs(digit / 2 - 1) < 1e-9 ||
                     std::abs(digit / 5 - 1) < 1e-9,
                 qPrintable(QString::number(says)));
        QVERIFY(4 * drawn < (1 + 1e-6) * widget->width() && 4 * next * drawn > widget->width());
      }
  }

  void spotsAndFansAreThoseOfARoundLens() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(click_menu({"View", "Main lens", "Spot diagram..."}));
    auto* const spots = child<LensDiagrams>("spotWindow");
    QVERIFY(until([&] { return spots->plots()[0]->series().size() == 2; }));
    const QVector<QPointF> axis = spots->plots()[0]->series()[1].points;  // [um]
    QVERIFY(axis.size() > 20);
    // On the axis a round lens has a round spot about it: what is on one side is on the other.
    double squares = 0, x = 0, y = 0;
    for (const QPointF& at : axis) {
      squares += at.x() * at.x() + at.y() * at.y();
      x += at.x();
      y += at.y();
    }
    const double rms = std::sqrt(squares / axis.size());
    QVERIFY(std::hypot(x, y) / axis.size() < 0.02 * rms);
    // Its radius is the one that is told, to the digits that are written.
    QString told;
    for (const QLabel* label : spots->findChildren<QLabel*>())
      if (label->text().startsWith("at 0.00 deg")) told = label->text();
    const double radius =
        parse_quantity(told.section("RMS radius ", 1).toStdString(), Dimension::length);
    QVERIFY2(std::abs(1e6 * radius / rms - 1) < 0.01, qPrintable(told));
    // Off the axis there is coma and astigmatism as well.
    QVERIFY(spots->plots()[2]->series()[1].points != axis);
    // Its shape is drawn as it is: a length is as long across as up, and in all three.
    spots->grab();
    const auto unit = [](double range, double length) { return range / length; };
    const double across =
        unit(spots->plots()[0]->range().width(), spots->plots()[0]->area().width());
    for (const PlotWidget* plot : spots->plots()) {
      QVERIFY(std::abs(unit(plot->range().width(), plot->area().width()) / across - 1) < 1e-9);
      QVERIFY(std::abs(unit(plot->range().height(), plot->area().height()) / across - 1) < 1e-9);
    }
    spots->close();
    QApplication::setActiveWindow(window_.get());  // as a window manager would
    QVERIFY(click_menu({"View", "Main lens", "Ray fans..."}));
    auto* const fans = child<LensDiagrams>("fanWindow");
    QVERIFY(until([&] { return fans->plots()[0]->series().size() == 3; }));
    // One scale for all three, with no aberration in its middle.
    fans->grab();
    for (const PlotWidget* plot : fans->plots()) {
      QCOMPARE(plot->range().bottom(), fans->plots()[2]->range().bottom());
      QVERIFY(std::abs(plot->range().center().y()) < 1e-9 * plot->range().height());
    }
    const auto fan = [&] { return fans->plots()[0]->series()[0].points; };
    const QVector<QPointF> before = fan();
    double most = 0;
    for (const QPointF& at : before) most = std::max(most, std::abs(at.y()));
    QVERIFY(most > 0);
    // Odd on the axis, and the same in both planes.
    const QVector<QPointF> sagittal = fans->plots()[0]->series()[1].points;
    for (int i = 0; i < before.size(); ++i) {
      const QPointF &one = before[i], &other = before[before.size() - 1 - i];
      QVERIFY(std::abs(one.x() + other.x()) < 1e-6);
      QVERIFY(std::abs(one.y() + other.y()) < 1e-3 * most);
      QVERIFY(std::abs(one.y() - sagittal[i].y()) < 1e-3 * most);
    }
    // They follow every change.
    const double curved = session().document().camera().lens.surfaces[0].radius;
    session().document().set_value("camera.lens.surfaces[0].radius",
                                   format_quantity(1.1 * curved, Dimension::length));
    QVERIFY(until([&] { return !fan().isEmpty() && fan() != before; }));
    fans->close();
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

#pragma once
#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <QEvent>
#include <QTimer>
#include <QWidget>
#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "model/flame_look.h"
#include "model/jobs/latest_task.h"
#include "model/jobs/ray_selector.h"
#include "model/scene_changes.h"
#include "model/schematic.h"
#include "plenoflame/scene/compile.h"

class QAction;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QSlider;
class vtkPolyData;
class vtkRenderer;

namespace plenoflame::desktop {

class Notice;
class ToolRow;
struct SceneGeometry;

/// The scene in three dimensions: flame, lens, array, sensor with the live image, rays.
///
/// Drag turns, wheel zooms, middle drag moves. A click on the flame, the sensor or the array
/// selects.
class SceneView : public QWidget {
  Q_OBJECT
 public:
  enum class Part { scene, flame, camera, array, pixel };

  explicit SceneView(QWidget* parent = nullptr);
  ~SceneView() override;

  /// Geometry follows in the background. @param changes since the scene before
  /// @param others further cameras, which are shown in the whole scene
  void set_scene(std::shared_ptr<const CompiledScene> scene, const SceneChanges& changes,
                 std::vector<CameraSpec> others = {});
  /// Shows nothing, and aims at the next scene again.
  void clear();
  /// While it is held it shows what it showed before, and costs nothing; then all that has changed.
  void hold(bool on);
  /// Why it does not show the present scene; empty: it does.
  void set_notice(const QString& text);
  /// @param chosen the ray that stands out; -1: none
  void set_rays(std::shared_ptr<const SelectedRays> rays, int chosen = -1);
  void set_highlighted(int ray);
  /// @param picture of picture_on_sensor(); null: none
  void set_picture(vtkSmartPointer<vtkImageData> picture);
  void set_flame_look(const FlameLook& look);
  const FlameLook& flame_look() const { return look_; }
  /// Takes a drawing that is shown instead of the one in three dimensions while *Section* is on.
  void set_section(QWidget* section);
  void show_section(bool on);
  bool shows_section() const;
  void show_part(Part part);
  /// Looks from where the other one does from now on: what turns one turns both.
  void look_as(SceneView& other);
  Part part() const { return part_; }
  /// Draws one of each kind of thing invisibly, so that programs for the graphics card are compiled
  /// now and not in use. Software OpenGL compiles them on the processor. Call it after the window
  /// has its place on the screen, but before it is shown.
  void warm_up();
  /// The view as it is now, without the window around it; as finely as it can be drawn, however
  /// long that takes.
  QImage picture();
  /// The same of another size [pixel], on another ground, without cube and scale bar.
  /// @param metres receives the length of a pixel in the plane through the middle of the view
  QImage poster(const QSize& size, const QColor& background, double& metres);
  /// True if everything that it was given is drawn.
  bool is_current() const;
  /// Temperatures [K] between which nearly all of the flame's emission lies, the ends of the
  /// colours; 0, 0: there is none.
  std::array<double, 2> flame_temperatures() const { return temperatures_; }
  /// Width and height of what the camera sees at its focus [m].
  double view_height() const;
  std::array<double, 2> clipping_range() const;
  /// Place at which a point of the world [m] is seen, on the widget "scene3d" [logical pixel].
  QPointF to_widget(const Vec3& world) const;
  /// Distance between the two clicks of *Measure* [m]; 0: there are none yet.
  double measured() const;
  /// Drawing of the whole scene as it is now: with shortened gaps, or to scale.
  const Schematic& schematic() const { return schematic_; }
  /// Places at which the front vertices of further cameras are seen, in their order [logical
  /// pixel].
  std::vector<QPointF> other_cameras_seen() const;
  /// Places of the handles that move things [m] world; the last one is the camera's. None unless
  /// *Move* is on.
  std::vector<Vec3> handles() const;

 signals:
  void pixel_picked(int column, int row);
  void lens_picked(const plenoflame::LensIndex& lens);
  void point_picked(const plenoflame::Vec3& point);
  void measured_changed(double distance);
  void picture_requested();
  /// A button above the view was clicked; nothing is shown yet.
  void part_requested(int part);
  void look_edited(const plenoflame::desktop::FlameLook& look, const QString& what);
  /// A handle is being dragged. @param flame its number; -1: the camera
  /// @param position [m] that it goes to  @param stroke the same for all of one drag
  void moved(int flame, const plenoflame::Vec3& position, int stroke);
  /// The pointer is over this; of kind none: over nothing.
  void pointed(const plenoflame::desktop::Selection& target);

 protected:
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  struct View;
  void make_tools();
  void make_drawing_tools();
  void draw_to_scale();
  void update_schematic();
  void add_gaps();
  void add_gaps_of(std::size_t camera, vtkRenderer& renderer);
  void place_handles();
  /// @return whether the event belongs to a handle
  bool drag_handle(QEvent::Type event, const QPointF& at);
  void run_light(bool on);
  void move_light();
  void find_ways();
  void look_along(int axis);
  void build_geometry();
  void add_geometry();
  void add_layers();
  void show_next();
  void show_all();
  void add_flame();
  void show_flame();
  void add_volume(vtkImageData& flame, vtkRenderer& renderer);
  /// True if the flames are drawn as eyes see them, or will be once their light is known.
  bool shows_eye() const;
  void find_light();
  void add_rays();
  void add_camera();
  void add_picture();
  /// Middle of the selected pixel, or of the sensor [columns, rows].
  std::array<double, 2> pixel() const;
  /// Shows microlenses where they are seen large, and plates elsewhere.
  void add_arrays();
  /// Updates, before each drawing, whatever depends on the eye's place.
  void follow_eye();
  /// Makes the parts of a camera seen before the dark, and its glass mirror.
  void polish(const std::string& layer);
  void add_housings();
  /// The body of a camera, where it is in the world; null: none is shown.
  vtkPolyData* housing_shown(std::size_t camera) const;
  void add_surroundings();
  /// True if flame, solid surfaces and windows belong to the present part.
  bool shows_flame() const { return part_ == Part::scene || part_ == Part::flame; }
  /// Corners of what the present part shows, where they are drawn [m], and from which side it is
  /// seen.
  void add_solids(std::vector<Vec3>& points) const;
  std::vector<Vec3> drawn_subject(Vec3& from) const;
  /// Place at which a point of the drawing is seen, on the widget "scene3d" [logical pixel].
  QPointF drawn_to_widget(const Vec3& drawn) const;
  /// The reverse. @param depth as VTK's: 0 at the near plane, 1 at the far one
  Vec3 drawn_at(const QPointF& place, double depth) const;
  /// The point of the drawing that is seen there. It lies on a surface, in the flame's middle, or
  /// in the plane through the middle of the view.
  Vec3 thing_at(const QPointF& place) const;
  /// Moves the eye towards the thing there.
  void zoom(const QPointF& place, double factor);
  /// Drawing of the axis of a camera: 0 is the one that everything is about.
  Schematic schematic_of(std::size_t camera) const;
  void aim();
  /// True while the user has not turned, moved or zoomed the view since it was aimed.
  bool is_as_aimed() const;
  void fit_to_size();
  /// All of these points, beside the bar of colours.
  void look(const std::vector<Vec3>& drawn, const Vec3& direction, const Vec3& up);
  void follow(const std::array<double, 6>& flame_before);
  /// The selection that a click there would make.
  Selection target_at(const QPointF& place) const;
  void pick(const QPointF& place);
  void show_measured();
  void render();
  bool is_close() const { return part_ == Part::array || part_ == Part::pixel; }

  std::unique_ptr<View> view_;
  std::shared_ptr<const CompiledScene> scene_;
  std::vector<CameraSpec> others_;
  std::shared_ptr<const SelectedRays> rays_;
  vtkSmartPointer<vtkImageData> picture_;  ///< on the sensor; null: none
  std::shared_ptr<SceneGeometry> geometry_;
  FlameLook look_;
  Part part_ = Part::scene;
  std::array<double, 2> temperatures_{0, 0};
  std::array<double, 3> aimed_from_{}, aimed_up_{};
  int highlighted_ = -1;
  bool aimed_ = false, warm_ = false, held_ = false;
  bool along_axis_ = false;  ///< aimed along x, y or z rather than as the part is seen best
  bool first_ = true;        ///< geometry: its parts come one by one
  ToolRow* tools_ = nullptr;
  QWidget* section_ = nullptr;
  std::vector<QWidget*> space_tools_;  ///< of three dimensions, which the section has no use for
  QComboBox *drawing_ = nullptr, *cut_ = nullptr, *housing_ = nullptr;
  QSlider* cut_place_ = nullptr;
  Notice* notice_ = nullptr;
  std::array<QAction*, 5> part_actions_{};
  QAction *measure_ = nullptr, *shortened_ = nullptr, *move_ = nullptr, *light_ = nullptr,
          *section_mode_ = nullptr;
  Schematic schematic_;
  std::vector<Schematic> other_schematics_;  ///< of others_; fewer: those are to scale
  int dragged_ = -1, stroke_ = 0;            ///< number of the handle that is dragged; -1: none
  QPointF pressed_;
  QTimer render_later_, show_later_, light_timer_;
  QDoubleSpinBox* exposure_ = nullptr;
  std::vector<std::shared_ptr<const Medium>> lit_;  ///< the flames whose light is known, or sought
  bool light_known_ = true;
  unsigned newest_ = 0, built_ = 0;
  LatestTask light_task_{Urgency::work};
  LatestTask task_{Urgency::work};  ///< last: it ends first
};

}  // namespace plenoflame::desktop

#pragma once
#include <QObject>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "model/scene_changes.h"
#include "model/undo_history.h"
#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/presets.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/validate.h"

namespace plenoflame::desktop {

/// The thing that the user points at. Every view shows it in its own way.
struct Selection {
  enum class Kind { none, pixel, microlens, point };
  Kind kind = Kind::none;
  int column = 0, row = 0;  ///< pixel
  LensIndex lens;           ///< microlens
  Vec3 point;               ///< [m] world

  static Selection of_pixel(int column, int row) {
    Selection selection;
    selection.kind = Kind::pixel;
    selection.column = column;
    selection.row = row;
    return selection;
  }
  static Selection of_microlens(LensIndex lens) {
    Selection selection;
    selection.kind = Kind::microlens;
    selection.lens = lens;
    return selection;
  }
  static Selection of_point(Vec3 point) {
    Selection selection;
    selection.kind = Kind::point;
    selection.point = point;
    return selection;
  }
};
bool operator==(const Selection& a, const Selection& b);

/// A scene that was not saved before the program ended.
struct RecoveredScene {
  std::string path;  ///< of the copy
  std::string file;  ///< where it had been saved; empty: nowhere
  std::string text;
};

/// Contents of a file that can be opened.
struct FileContent {
  enum class Kind { scene, flame, light_field };
  Kind kind = Kind::scene;
  std::string path;
  SceneDocument scene;                      ///< of a scene or a light field
  std::shared_ptr<const LightField> image;  ///< of a light field
};

/// The subject of the window: a scene with its history, the light field that belongs to it, and
/// what is selected. Knows no widgets and computes nothing.
///
/// A function that throws leaves the document as it was. The messages are those of the command
/// line.
class Document : public QObject {
  Q_OBJECT
 public:
  explicit Document(QObject* parent = nullptr);

  bool is_empty() const { return empty_; }
  const Scene& scene() const { return history_.state().scene; }
  const PositionMap& positions() const { return history_.state().positions; }
  /// Name of the camera that everything is about but the scene's own values: what is rendered,
  /// traced and shown. Empty where there is but one.
  const std::string& camera_name() const { return camera_; }
  const CameraSpec& camera() const;
  /// The scene with that camera alone. The document must be valid.
  SceneDocument scene_of_camera() const;
  /// Chooses another one. It is no change of the scene. @throws InputError when there is none
  void choose_camera(const std::string& name);
  /// The moment at which a scene that changes is shown [s]; none: its first picture.
  const std::optional<double>& time() const { return time_; }
  /// The scene at that moment, which reads the files that say how it changes. May be called by any
  /// thread. @param scene of one camera @throws InputError, FileError as SceneTimeline
  static Scene at_moment(const SceneDocument& scene, const std::optional<double>& time);
  /// Chooses another one. It is no change of the scene.
  void choose_time(double seconds);
  /// Path under which the scene is saved; empty: nowhere yet.
  const std::string& file() const { return file_; }
  /// Name for people: the file's name without folder, or "untitled".
  std::string name() const;
  bool is_modified() const { return !empty_ && !history_.saved(); }

  /// Opens a file by its ending. A scene is .toml. A flame (.vdb) is put before the present camera,
  /// or the default one. A raw light field (.exr) is opened with the scene that it holds.
  /// @throws FileError, InputError, UsageError (another ending)
  void open(const std::string& path) { open(read(path)); }
  /// The two halves of it. The first one takes long for what is large, and may run on any thread.
  /// @throws FileError, InputError, UsageError (another ending), Cancelled
  static FileContent read(const std::string& path, const std::stop_token& stop = {});
  void open(FileContent content);
  /// Takes a scene that has no file of its own. @param name for messages and relative paths
  void open_text(const std::string& text, const std::string& name);
  /// The same after a crash: it counts as changed.
  void recover(const RecoveredScene& recovered);
  /// Saves the scene; files that it names stay the same ones. @throws FileError, InputError
  void save(const std::string& path);

  /// Sets one value from text with a unit. @throws InputError, see set_value_text()
  /// @param merge see UndoHistory::push
  void set_value(const std::string& path, const std::string& text, const std::string& merge);
  /// The same; values of one path in a row are one step, as of a slider.
  void set_value(const std::string& path, const std::string& text) { set_value(path, text, path); }
  void insert_item(const std::string& list, std::size_t position);
  void erase_item(const std::string& list, std::size_t position);
  /// Starts a camera, a lens or a flame from a preset. The place of a camera or a flame in the
  /// world is kept.
  /// @param index of the flame, or of one of several cameras
  void apply_preset(PresetKind kind, const std::string& name, std::size_t index = 0);
  /// Any other change. @param what for the menu  @param merge see UndoHistory::push
  void change(const Scene& scene, const std::string& what, const std::string& merge = {});

  /// Look of the flame in 3-D. It is not part of the scene's file, but can be undone.
  const FlameLook& look() const { return history_.look(); }
  /// @param what for the menu  @param merge see UndoHistory::push
  void set_look(const FlameLook& look, const std::string& what, const std::string& merge = {});
  /// The look to begin with; no step to undo.
  void begin_look(const FlameLook& look);

  bool can_undo() const { return history_.can_undo(); }
  bool can_redo() const { return history_.can_redo(); }
  std::string undo_text() const { return history_.undo_text(); }
  std::string redo_text() const { return history_.redo_text(); }
  void undo();
  void redo();

  /// The issues that check_scene() finds in the present state, and those of the files it names.
  const std::vector<SceneIssue>& issues() const { return issues_; }
  /// True if check_scene() finds no error, so that the scene can be computed.
  bool is_valid() const { return valid_; }
  /// Sets the issue that was found when the files that the scene names were read; null: none. It is
  /// forgotten with the next change.
  void set_unreadable(const SceneIssue* issue);

  /// The raw light field that is shown; null: none yet. One from before a
  /// change stays as long as the camera keeps its number of pixels.
  const std::shared_ptr<const LightField>& image() const { return image_; }
  /// True if the image was made from the present scene.
  bool image_is_current() const { return image_ && image_current_; }
  void set_image(std::shared_ptr<const LightField> image);

  const Selection& selection() const { return selection_; }
  void select(const Selection& selection);

 signals:
  void scene_changed(const plenoflame::desktop::SceneChanges& changes);
  /// More or less is known to be wrong with it, without a change.
  void issues_changed();
  void look_changed();
  void image_changed();
  void selection_changed();
  /// Name, whether it is modified, what can be undone.
  void state_changed();

 private:
  void begin(SceneDocument scene, const std::string& file, std::shared_ptr<const LightField> image);
  void push(SceneDocument state, const std::string& what, const std::string& merge = {});
  void after(const Scene& before, const FlameLook& look_before);
  void check();
  void drop_image_of_other_size();

  UndoHistory history_;
  /// Chooses the first of several cameras when there is none of the chosen name.
  void keep_camera();

  std::string file_, camera_;
  std::optional<double> time_;
  std::vector<SceneIssue> issues_;
  std::shared_ptr<const LightField> image_;
  Selection selection_;
  std::vector<SceneIssue> unreadable_;  ///< one, or none
  bool empty_ = true, valid_ = false, image_current_ = false;
};

/// The scene with the files that it names as seen from another scene file.
Scene moved_to(Scene scene, const std::string& file);

}  // namespace plenoflame::desktop

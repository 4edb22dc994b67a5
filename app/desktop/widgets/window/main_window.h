#pragma once
#include <QMainWindow>
#include <QSettings>
#include <QTimer>
#include <functional>
#include <memory>
#include <string>

#include "model/recovery.h"
#include "model/session.h"
#include "widgets/controls/file_chooser.h"

class QLabel;
class QMenu;
class QSplitter;
class QToolButton;
class QVBoxLayout;

namespace plenoflame::desktop {

class DesignPanel;
class FileTasks;
class FlamePanel;
class HelpWindow;
class ImagePanel;
class LightFieldPanel;
class RaysPanel;
struct Preferences;
class ReconstructPanel;
class RenderPanel;
class ScenePanel;
class SceneView;
class SectionView;
class SidePanel;
class ViewCommands;
class WelcomePage;

/// The window. It shows the session and passes on the user's actions. Messages go to its status bar
/// or, when a requested action failed, into a dialog.
class MainWindow : public QMainWindow {
  Q_OBJECT
 public:
  /// @param settings where the user's settings are kept; taken
  /// @param recovery_folder for scenes that were not saved; empty: none are kept
  MainWindow(std::unique_ptr<QSettings> settings, const std::string& recovery_folder);
  ~MainWindow() override;

  Session& session() { return session_; }
  ImagePanel& image_panel() { return *image_; }
  SceneView& scene_view() { return *scene_view_; }
  SectionView& section_view() { return *section_; }
  ScenePanel& scene_panel() { return *scene_; }
  RaysPanel& rays_panel() { return *rays_; }
  RenderPanel& render_panel() { return *render_; }
  LightFieldPanel& light_field_panel() { return *light_field_; }
  FlamePanel& flame_panel() { return *flame_; }
  ReconstructPanel& reconstruct_panel() { return *reconstruct_; }
  SidePanel& side_panel() { return *side_; }

  /// Shows the window and draws it, before anything is computed that would keep the processors from
  /// it. Returns soon where the screen has no room for it, too.
  void appear();
  /// Opens a file; what goes wrong is said in a dialog. Scenes are open when it returns; flames and
  /// light fields, which may be large, are read in the background. False: it was not begun.
  /// @param then is called once it is open
  bool open(const QString& path, const std::function<void()>& then = {});
  bool open_example(const QString& name);
  /// Takes a picture of a real camera, that of the present scene, to hold the simulated one
  /// against. False: it was not begun.
  bool open_measured(const QString& path, const std::function<void()>& then = {});
  /// A scene to begin with, which has no file yet.
  bool open_new();
  bool save();
  bool save_as();
  /// Offers what was left behind by a program that ended without saving. @return whether it was
  /// taken, and is open now
  bool offer_recovery();
  /// Begins the program. It first offers the recovered scene. If the user takes it, the file is not
  /// opened, and a message says so.
  /// @param file empty: none was given
  /// @return whether something was opened, or begun to be
  bool begin(const QString& file, const std::function<void()>& then = {});
  /// True while files are being read or written.
  bool is_file_busy() const;
  /// Every request is on display: nothing is being computed.
  bool is_settled() const;
  /// Questions are answered with yes and dialogs are not shown but kept: for tests and screenshots.
  void set_unattended(bool on) { unattended_ = on; }
  const QString& last_message() const { return last_message_; }
  /// Does as the options of the command line ask; empty ones are left alone. @return what is wrong
  QString apply_options(const QString& pixel, const QString& part, const QString& panel, bool dark);
  /// Writes a picture of the window, its 3-D view included.
  bool save_screenshot(const QString& path);

 protected:
  void showEvent(QShowEvent* event) override;
  void closeEvent(QCloseEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  void make_views();
  void make_side_panel();
  void make_status_line();
  void connect_panels();
  void make_menus();
  void make_view_menu(QMenu& menu);
  void connect_session();
  void show_state();
  void show_pixel_of_picture();
  void connect_selection();
  void place_split();
  void reset_layout();
  void show_welcome(bool on);
  void place_welcome();
  void show_part(int index);
  void set_dark(bool dark);
  void update_title();
  void undo();
  QString not_taken() const;
  void show_selection();
  void add_recent(const QString& path);
  void update_recent();
  void fail(const QString& message);
  bool may_discard();
  void show_about();
  void start_tour();
  void make_film();
  void choose_measured();
  void say_gain();
  void renew_measured();
  void compare_with(const QString& file);
  void select_next_type();
  void show_preferences();
  void apply_preferences(const Preferences& wanted);
  void open_help();
  void export_picture_of_scene();
  void export_poster();
  void write_picture(const QImage& picture, const QString& title);
  void export_rays();
  void save_reconstruction();
  void export_image();
  void export_derived();
  void export_views();
  void export_for_tool(int format);
  void make_export_menu(QMenu& menu);
  void generate_flame();
  void import_flame();
  void map_grids(int flame);
  /// A folder to write into. Asks before files in it are replaced.
  QString folder_to_fill(const QString& title);
  void say_written(const QString& name);
  void select_lens_at(int column, int row);
  void move_thing(int flame, const Vec3& position, int stroke);
  /// Says in the status bar what the pointer is over in 3-D.
  void show_pointed(const Selection& target);
  /// Calls it; what it throws is said, and the result false.
  bool guarded(const std::function<void()>& function);

  std::unique_ptr<QSettings> settings_;
  FileChooser chooser_;
  std::unique_ptr<Recovery> recovery_;
  Session session_;
  WelcomePage* welcome_ = nullptr;
  ImagePanel* image_ = nullptr;
  SceneView* scene_view_ = nullptr;
  SectionView* section_ = nullptr;
  SidePanel* side_ = nullptr;
  QSplitter* split_ = nullptr;        ///< side panel, 3-D, light field
  QVBoxLayout* workspace_ = nullptr;  ///< split_, and the widgets below it
  ViewCommands* view_commands_ = nullptr;
  ScenePanel* scene_ = nullptr;
  RaysPanel* rays_ = nullptr;
  RenderPanel* render_ = nullptr;
  LightFieldPanel* light_field_ = nullptr;
  DesignPanel* design_ = nullptr;
  FlamePanel* flame_ = nullptr;
  ReconstructPanel* reconstruct_ = nullptr;
  QMenu* recent_menu_ = nullptr;
  QAction *undo_ = nullptr, *redo_ = nullptr, *dark_ = nullptr;
  QLabel* pointer_label_ = nullptr;
  QToolButton* status_line_ = nullptr;
  QTimer autosave_;
  bool unattended_ = false;
  bool split_by_hand_ = false, had_selection_ = false;
  QString last_message_;
  QTimer measured_later_;       ///< it is read once more
  QString standing_failure_;    ///< in the status bar until it is mended
  unsigned scenes_opened_ = 0;  ///< at once, without files_
  FileTasks* files_ = nullptr;
  HelpWindow* help_ = nullptr;
};

}  // namespace plenoflame::desktop

#pragma once
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

#include "plenoflame/math/vector.h"

class vtkRenderer;
class vtkTextActor;
class vtkTextProperty;

namespace plenoflame::desktop {

constexpr double kTextGround = 0.75;  ///< opacity of the ground of a text

/// Keeps texts in front of a 3-D view readable over its drawing.
void set_text_ground(vtkTextProperty& style);

/// Part of a drawing [screen pixel], from the lower left corner.
struct ScreenBox {
  double left = 1e300, bottom = 1e300, right = -1e300, top = -1e300;
  bool empty() const { return !(left < right && bottom < top); }
  void add(double x, double y);
  double overlap(const ScreenBox& other) const;  ///< area of what both cover [pixel^2]
};

/// Texts of a 3-D view, each beside its thing where there is room. A text covers neither other
/// texts nor the marks that must be seen. It covers other things only if it must. A thin line leads
/// from a distant text to its thing.
class SceneLabels {
 public:
  enum class Keep { off, off_if_possible };

  void clear();
  /// @param beside points of the world, as drawn, that bound the thing. Texts that are added first
  /// have the first choice.
  void add(const std::string& text, std::vector<Vec3> beside, int font_size, vtkRenderer& renderer);
  /// @param thing points of the world, as drawn, that bound it
  void avoid(std::vector<Vec3> thing, Keep keep);
  /// To be called before each drawing, as the texts stay beside things while the view is turned.
  /// @param furniture bars and cube in front of the view
  void place(vtkRenderer& renderer, const std::vector<ScreenBox>& furniture) const;

 private:
  struct Label {
    vtkSmartPointer<vtkTextActor> actor;
    std::vector<Vec3> beside;
  };
  struct Thing {
    std::vector<Vec3> points;
    Keep keep = Keep::off;
  };
  std::vector<Label> labels_;
  vtkSmartPointer<vtkPolyData> leaders_;  ///< lines on the screen; null: there are no texts
  std::vector<Thing> things_;
};

}  // namespace plenoflame::desktop

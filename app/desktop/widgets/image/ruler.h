#pragma once
#include <string>

class vtkDistanceWidget;

/// The line that measures a distance in the 3-D view.
namespace plenoflame::desktop {

/// Makes what it draws: plain text, and ends where clicks are seen.
void set_up_ruler(vtkDistanceWidget& ruler);
void set_ruler_dark(vtkDistanceWidget& ruler, bool dark);
void set_ruler_text(vtkDistanceWidget& ruler, const std::string& text);
/// Between its ends [m].
double ruler_length(vtkDistanceWidget& ruler);

}  // namespace plenoflame::desktop

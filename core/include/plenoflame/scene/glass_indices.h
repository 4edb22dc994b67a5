#pragma once
#include <string>

#include "plenoflame/scene/scene_file.h"

namespace plenoflame {

/// Wavelength at which a scene's indices are taken: the centre of its first channel that is a band,
/// or the d line [m, vacuum].
double design_wavelength(const Scene& scene);

/// Sets the index of every surface and microlens type that names a glass, at one wavelength [m].
/// @param path of the camera in the scene
/// @throws InputError for an unknown glass, with its position when known
void set_indices(CameraSpec& camera, double wavelength, const PositionMap& positions = {},
                 const std::string& path = "camera");

/// The same for windows.
void set_indices(std::vector<WindowSpec>& windows, double wavelength,
                 const PositionMap& positions = {});

/// Both at design_wavelength(), of all cameras.
void set_indices(Scene& scene, const PositionMap& positions = {});

}  // namespace plenoflame

#pragma once
#include <vtkSmartPointer.h>

#include <string>

class vtkDataSet;

namespace plenoflame::simulation {

/// Raw little-endian float32 files described by a JSON file beside them:
///     {"dimensions": [nx, ny, nz], "spacing_m": [dx, dy, dz], "origin_m": [x, y, z],
///      "arrays": {"T": "T.raw", "kappa": "kappa.raw"}}
/// x runs fastest. @throws FileError, InputError (what is missing, a file of the wrong size)
vtkSmartPointer<vtkDataSet> read_raw_bricks(const std::string& path);

}  // namespace plenoflame::simulation

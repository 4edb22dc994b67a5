{"I": 1, "dist_focus": 450,
 "main_lens": {"f": 50, "aperture": 4},
 "sensor": {"width": 800, "height": 600, "scale": 0.0055, "pose": {"translation": [[-2.197, -1.647, -57.1]]}},
 "mla": {"focal_lengths": [0.55],
         "mesh": {"geometry": 1, "width": 40, "height": 30, "pitch": [[0.127, 0.127]],
                  "pose": {"translation": [[-2.5, -1.6, -56.7]]}}},
 "distortions": {"radial": [[2.5e-4, 0, 0]], "tangential": [[0, 0]]}}

#pragma once

namespace perception {

/// How densely and where the engine of part models searches.
struct DpmOptions {
  int levels_per_octave = 5;  ///< method.md 8.8; [girshick2012]: 10
  double enlarge = 1;         ///< [1, 4] size of the first image searched (assumed)
  double outside = 0.4;       ///< share of an object's sides beyond the image (assumed)
  int window = 4;             ///< [cells of a part] how far a part may move [girshick2012]
  double overlap = 0.5;       ///< of the weaker box: more is the same object (method.md 8.8)
};

}  // namespace perception

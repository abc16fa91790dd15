#pragma once

#include "tests/fuzz/stream_image.hpp"

/// What is done with hostile regions. Each target takes any image and returns; it throws Broken if
/// a promise is broken, and the process dies of a read, or store, outside a region. Regions may be
/// refused by the exceptions that the roles document.
///
/// The script is a sequence of actions, a byte each with numbers behind it: samples at times near
/// the segments' ends, snapshots, appends, replacements, solver steps, and words changed meanwhile
/// as by another process.
namespace splinecast::fuzz {

/// Reads the board, mapped read-only: sample, preview, snapshot, heads, refusals, settled segments.
void try_reader(const StreamImage& image);

/// A solver and a producer go on with both regions, and a reader reads what they publish.
void try_writers(const StreamImage& image);

/// Reader, `info`, solver and producer, as real roles, on files in shared memory.
void try_roles(const StreamImage& image);

/// All of them, one after the other.
void try_all(const StreamImage& image);

}  // namespace splinecast::fuzz

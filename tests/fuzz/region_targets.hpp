#pragma once

#include "tests/fuzz/stream_image.hpp"

/// Targets for hostile regions. Each target accepts any image. It throws Broken if a promise is
/// broken, and an access outside a region ends the process. Regions may be refused with the
/// exceptions that the roles document.
///
/// The script is a sequence of actions, each one byte followed by its numbers: samples near the
/// segments' ends, snapshots, appends, replacements, solver steps, and changes of words like those
/// of another process.
namespace splinecast::fuzz {

/// Reads the board, mapped read-only: samples, previews, snapshots, summaries, refusals, settled
/// segments.
void try_reader(const StreamImage& image);

/// Lets a solver and a producer take over both regions, and reads what they publish.
void try_writers(const StreamImage& image);

/// Runs the real roles on files in shared memory: reader, `info`, solver, producer; of a time law
/// also its commander, and the roles of a stream that follows it.
void try_roles(const StreamImage& image);

/// Runs all three targets.
void try_all(const StreamImage& image);

}  // namespace splinecast::fuzz

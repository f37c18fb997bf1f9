// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// Installs handlers: SIGINT, SIGTERM, SIGHUP and SIGPIPE then remove what OutputFolder and
/// OutputFile have not committed, and end the process with exit code 128 + signal; a commit that
/// has begun is finished first. SIGXFSZ is ignored, so that a file size limit is an error of the
/// write. Signals that the process was started to ignore stay ignored. For the main function of a
/// command: starts a thread.
void install_signal_cleanup();

/// Returns immediately; never after such a signal. A command calls it before it reports its result,
/// so that files removed by the cleanup are not reported as errors.
void wait_if_interrupted();

}  // namespace pcavr

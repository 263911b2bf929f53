#pragma once
#include "server/apps/scene_arguments.h"
#include "server/control/scene_config.h"

namespace obliq {

/// Until a daemon runs, SIGINT and SIGTERM end the process at once: there is nothing to lose yet. Also where
/// they were ignored at the start, as by a script's `obliqd &`, since the daemon will heed them too.
void heed_signals_before_start();

/// Takes the ports, answers HTTP, loads the scene and serves it until a signal says stop. SIGHUP reads the
/// scene file again, with the same arguments. Throws InputError.
void run_daemon(SceneConfig config, SceneArguments arguments);

}  // namespace obliq

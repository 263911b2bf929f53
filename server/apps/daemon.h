#pragma once
#include "server/control/scene_config.h"

namespace obliq {

/// Until a daemon serves, SIGINT and SIGTERM end the process at once: there is nothing to lose yet. Also
/// where they were ignored at the start, as by a script's `obliqd &`, since the server will heed them too.
void heed_signals_while_loading();

/// Takes the port, loads the scene and serves it until a signal says stop. Throws InputError.
void run_daemon(SceneConfig config);

}  // namespace obliq

#pragma once

namespace obliq {

/// From now on SIGINT and SIGTERM are noted instead of ending the process; a second one ends it.
void heed_interrupts();

/// Whether one has come.
bool interrupted();

}  // namespace obliq

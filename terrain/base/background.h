#pragma once

namespace obliq {

/// Makes the calling thread, and the threads that it will start, yield to others that want the processor.
/// Says whether that worked.
bool lower_own_priority();

}  // namespace obliq

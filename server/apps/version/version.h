#pragma once

namespace obliq {

/// "0.1.0+g8ed7052": the release and the commit that it was built from, "-dirty" after it where the sources
/// differ from that commit. The release alone where nothing says which commit it is.
const char* program_version();

}  // namespace obliq

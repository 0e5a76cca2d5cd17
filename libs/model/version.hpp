#pragma once

#include <string_view>

namespace jointcreep
{

// The program's version and the commit it was built from, as written into every file: "0.1.0+1a2b3c4d".
std::string_view version();

} // namespace jointcreep

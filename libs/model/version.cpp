#include "model/version.hpp"

#include "version_text.hpp"

namespace jointcreep
{

std::string_view version()
{
    return JOINTCREEP_VERSION;
}

} // namespace jointcreep

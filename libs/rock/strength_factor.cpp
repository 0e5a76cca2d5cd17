#include "rock/strength_factor.hpp"

#include "model/strength_factor.hpp"

namespace jointcreep::rock
{

std::vector<Rock> with_strength_divided(std::vector<Rock> rocks, double factor)
{
    for (Rock& rock : rocks) {
        if (rock.strength) {
            rock.strength->cohesion /= factor;
            rock.strength->tensile_strength /= factor;
            divide_tangent(rock.strength->friction_angle, factor);
        }
        divide_tangent(rock.dilation_angle, factor);
    }
    return rocks;
}

} // namespace jointcreep::rock

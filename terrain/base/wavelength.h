#pragma once

namespace obliq {

constexpr double kSpeedOfLight_m_s = 299792458.0;  // exact: SI Brochure, 9th edition, 2.2

constexpr double wavelength_at(double frequency_ghz) { return kSpeedOfLight_m_s / (frequency_ghz * 1e9); }

}  // namespace obliq

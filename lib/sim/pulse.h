/*
 * The pulse's length in range.
 */
#ifndef ASDIC_SIM_PULSE_H
#define ASDIC_SIM_PULSE_H

#include <asdic/ping.h>
#include <asdic/sonar.h>

/* Bins that a resolution cell is long. */
double asdic_pulse_bins(const asdic_sonar *sonar, double sound_speed_mps);

/* Whether that is longer than a bin. */
bool asdic_pulse_smears(const asdic_sonar *sonar, double sound_speed_mps);

/* What a ping of BINS has to hold before it is smeared: so many bins more, beyond the last, whose
 * pulses reach back into it; and all from this range on, whose pulses reach over the end of the
 * blanking, or from half of it. An end of the blanking that is a bin's within rounding is it. Where
 * nothing smears 0 and the blanking. */
size_t asdic_pulse_margin(const asdic_sonar *sonar, double sound_speed_mps, size_t bins);
double asdic_pulse_from_m(const asdic_sonar *sonar, double sound_speed_mps);

/* Doubles of scratch that a thread of asdic_pulse_smear needs for so many bins, margin included. */
size_t asdic_pulse_scratch(size_t bins);

/* Spreads every component's energy in FROM over a resolution cell c / (2 B), centred, when that is
 * longer than a bin, to the first bins, or all, of OUT, which may be FROM; nothing to do otherwise:
 * a bin then holds whole cells, and what leaks over its edges is at most half a cell's share. Before
 * the blanking's end no echo is heard. Stated errors follow the energy. Noise is the same in every
 * bin, and the total the sum of all. THREADS, at most, do it. SCRATCH: asdic_pulse_scratch of FROM's
 * bins for each. */
void asdic_pulse_smear(const asdic_sonar *sonar, double sound_speed_mps, unsigned threads,
                       double *scratch, const asdic_ping *from, asdic_ping *out);

/* The same for a ROW of energy, of which BINS are wanted and MARGIN follow. */
void asdic_pulse_smear_row(const asdic_sonar *sonar, double sound_speed_mps, double *scratch,
                           size_t bins, size_t margin, double *row);

/* Of an echo in bin N, the share that this bin keeps. */
double asdic_pulse_share(const asdic_sonar *sonar, double sound_speed_mps, size_t n);

#endif

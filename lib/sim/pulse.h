/*
 * The pulse's length in range.
 */
#ifndef ASDIC_SIM_PULSE_H
#define ASDIC_SIM_PULSE_H

#include <asdic/ping.h>
#include <asdic/sonar.h>

/* Bins that a resolution cell is long. */
double asdic_pulse_bins(const asdic_sonar *sonar, double sound_speed_mps);

/* Doubles of scratch that a thread of asdic_pulse_smear needs for so many bins. */
size_t asdic_pulse_scratch(size_t bins);

/* Spreads every component's energy over a resolution cell c / (2 B), centred, when that is longer
 * than a bin; nothing to do otherwise: a bin then holds whole cells, and what leaks over its edges
 * is at most half a cell's share. Beyond the last bin reverberation goes on, multipath with it, and
 * objects do not; before the blanking's end no echo is heard, and what lies nearer is lost as a
 * whole. Stated errors follow the energy. Noise is the same in every bin, and the total the sum of
 * all. THREADS, at most, do it. SCRATCH: asdic_pulse_scratch of the ping's bins for each. */
void asdic_pulse_smear(const asdic_sonar *sonar, double sound_speed_mps, unsigned threads,
                       double *scratch, asdic_ping *ping);

/* Whether it does anything; and the same for a ROW of energy of COMPONENT. */
bool asdic_pulse_smears(const asdic_sonar *sonar, double sound_speed_mps);
void asdic_pulse_smear_row(const asdic_sonar *sonar, double sound_speed_mps,
                           asdic_component component, double *scratch, size_t bins, double *row);

/* Of an object's echo in bin N of a ping of BINS, the share that this bin keeps. */
double asdic_pulse_share(const asdic_sonar *sonar, double sound_speed_mps, size_t bins, size_t n);

/* Of objects' energy, smeared as if it went on beyond the last bin, what bin N keeps as it does
 * not; of a pulse that smears. */
double asdic_pulse_kept(const asdic_sonar *sonar, double sound_speed_mps, size_t bins, size_t n);

#endif

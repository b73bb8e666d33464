/*
 * A measured curve: backscattering strength against grazing angle from a CSV file, linear in dB between
 * its angles. Below its first angle and above its last it stays what it is there. It is the user's for
 * his frequency, and says nothing about reflection.
 */
#include "keys.h"

#include "base/vec.h"

enum { CURVE };

static double row_deg(const asdic_scatterer *s, size_t row) {
    return s->material.rows[2 * row];
}

static double row_db(const asdic_scatterer *s, size_t row) {
    return s->material.rows[2 * row + 1];
}

static double strength_lin(const asdic_scatterer *s, const asdic_incidence *at) {
    double deg = atan2(at->sine, sqrt(at->cos2)) * (180.0 / ASDIC_PI);
    size_t below = 0, above = s->material.row_count - 1;
    if (deg <= row_deg(s, below)) {
        return pow(10.0, 0.1 * row_db(s, below));
    }
    if (deg >= row_deg(s, above)) {
        return pow(10.0, 0.1 * row_db(s, above));
    }
    while (above - below > 1) {
        size_t middle = (below + above) / 2;
        below = row_deg(s, middle) <= deg ? middle : below;
        above = row_deg(s, middle) <= deg ? above : middle;
    }
    double share = (deg - row_deg(s, below)) / (row_deg(s, above) - row_deg(s, below));
    return pow(10.0, 0.1 * (row_db(s, below) + share * (row_db(s, above) - row_db(s, below))));
}

static double knot_deg(const asdic_scatterer *s, size_t index) {
    return index < s->material.row_count ? row_deg(s, index) : NAN;
}

static const asdic_column columns[] = {{"grazing_deg", 0.0, 90.0, NULL},
                                       {"strength_db", -200.0, 60.0, NULL}};

const asdic_law asdic_law_curve = {
    .name = "curve",
    .uses = ASDIC_LAW_BOTTOM | ASDIC_LAW_OBJECT,
    .model = {"curve",
              "dB",
              "measured backscattering strength re 1 m^2/m^2, linear in dB between its angles",
              "the file's",
              2,
              {[CURVE] = {.name = "curve",
                          .required = true,
                          .chooses = true,
                          .columns = "grazing_deg,strength_db",
                          .doc =
                              "scatters as measured: CSV file of grazing_deg,strength_db, relative "
                              "to the scene file; beyond its angles as at its ends"},
               LAW_GRAZING}},
    .strength_lin = strength_lin,
    .knot_deg = knot_deg,
    .table = {columns, 2, "more than", ""},
};

#ifndef SIMPLE_H
#define SIMPLE_H

#ifndef AMOUNT_SCALE
#define AMOUNT_SCALE 1
#endif

#endif

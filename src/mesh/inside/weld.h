// Vertices at one place become one.
#ifndef CK_WELD_H
#define CK_WELD_H

// Numbers every vertex's place: places are those of the vertices that come first there, in their order.
//   position  [3*count] m;  distance  m, 0: equal coordinates;  place  [count] out
// Returns how many places there are, or −1 without memory. Cost: a constant a vertex, by a grid of that distance.
int ck_weld(int *place, const double *position, int count, double distance);

#endif

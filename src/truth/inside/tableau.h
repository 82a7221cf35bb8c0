// Explicit Runge–Kutta methods, by their Butcher tableaux.
#ifndef CK_TABLEAU_H
#define CK_TABLEAU_H

#define CK_MOST_STAGES 11

// Stage i is taken at the start's time plus nodes[i]·dt, and the start plus dt·Σ matrix[i][m]·k_m, m < i; the step ends
// at the start plus dt·Σ weights[i]·k_i.
typedef struct ck_Tableau {
    int order, stages;
    double nodes[CK_MOST_STAGES], weights[CK_MOST_STAGES], matrix[CK_MOST_STAGES][CK_MOST_STAGES - 1];
    double first_swing, first_decay; // dt·ω and dt·rate that a first path is stepped at: both are stable
    int first_steps;                 // and how many a frame has at least
} ck_Tableau;

// The classical one, stable to 2.83/ω and to 2.79 over a rate of damping, of which it starts at a quarter and at nine
// tenths. Source: Kutta 1901.
extern const ck_Tableau ck_tableau_fourth;
// Stable to 3.0/ω and to 3.7 over a rate; where motion swings it starts at as many stages a second. Source: Cooper and
// Verner 1972.
extern const ck_Tableau ck_tableau_eighth;

#endif

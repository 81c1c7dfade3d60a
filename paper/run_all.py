"""Run the whole study of the paper, one script after the other: about ten minutes on one core.

Tables go to the screen and, as CSV, to ``paper-output`` beside the figures.
"""

import os

# Before numpy is imported: threads cost more than they gain on matrices this small.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import common
import fig3_triangle
import fig4_stability
import fig5_functions
import fig6_force_curves
import fig7_time
import fig8_spectroscopy
import fig9_approach
import fig10_movie
import fold_scatter
import smooth_tap
import steady_taps

if __name__ == "__main__":
    common.run(
        fig3_triangle.main,
        fig4_stability.main,
        fig5_functions.main,
        fig6_force_curves.main,
        fig7_time.main,
        fig8_spectroscopy.main,
        fig9_approach.main,
        fig10_movie.main,
        fold_scatter.main,
        smooth_tap.main,
        steady_taps.main,
    )

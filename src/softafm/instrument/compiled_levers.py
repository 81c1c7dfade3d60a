"""Compiled levers, called once a step by the loop of the default solver."""

from math import inf

from softafm.compiled.functions import ACCEPTANCE, RESPONSE, compile_when_used


@compile_when_used(RESPONSE)
def hold(time, step, deflection, force, parameters, state):
    return deflection, inf


@compile_when_used(RESPONSE)
def bend(time, step, deflection, force, parameters, state):
    stiffness, drag = parameters[0], parameters[1] / step
    return deflection * drag / (1.0 + drag), stiffness * (1.0 + drag)


@compile_when_used(ACCEPTANCE)
def remember_nothing(time, step, before, force, parameters, state):
    return

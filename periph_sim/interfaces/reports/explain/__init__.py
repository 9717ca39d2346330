"""Explanation of the worst occurrence of each budget: the records around it, its causes, and a picture.

timing      verdict: the budget, its worst value and its instant
  |
window      a second run, recorded: all records around that instant                 (`windows`)
  |
evidence    queries of these records: phases on the bus, accesses, flags, CPU activity   (`Evidence`)
  |
findings    the records at both ends of the occurrence (`Ends`), and findings from the records around an instant
  |
explain     steps: events in order of time, with the causes of both ends
            parts: the shares of the time between the ends that the bus, parties that hold SCL, hardware, and firmware
                   took
  |
chain       the explanation as data, as text and as JSON                            (`Chain`)
picture, reports/html    pictures of the occurrence

An explanation is made from the records that a measure uses. Therefore, new measures of the same kinds of records need
no code here. Two expectations come from the case and not from a record: the text of a reply and the edges of a watched
wire.

Terms of this package:

window: the records around an occurrence, and a few earlier ones that give the state at its start.
ends: the two records at which an occurrence begins and ends; equal if it is an instant.
activity: a service routine, a span, a wait, or other code of a CPU. A span is a named part of the firmware, such as a
    function of an image.
wait: a loop that polls fields of registers until one of them changes, IDLE, or an endless loop.
image: a program that is executed instruction by instruction; other firmware consists of Python functions or C sources.
party: a unit, a device, the controller or another object that can drive a line of a bus.
phase: the part of an I2C transfer from a START or repeated START to the next one, a STOP or lost arbitration.
stretch: a time in which a CPU or the bus has one activity (`Stretch`). A stretch of SCL is a longer low time.
place: a location in the firmware.
thing: the last event of a measure, such as "refused".
"""

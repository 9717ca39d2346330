"""Coverage of a case's free phase: chosen starts of a frame, a round or a send are run, and failures become windows.

    case --phases--> runs in which each start comes a phase later than the one before --figures--> worst values
                     failures --windows--> first and last phase, each with a neighbour that held

Nothing here proves that a budget holds for ever: the runs begin in the states that they happen to reach, and the other
free inputs of the case take the values that it draws for them.
"""

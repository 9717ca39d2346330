"""Coverage of a case's free phase: every start of a frame, or of a round, is run, and failures become windows.

    case --phases--> runs in which each start comes a cycle later than the one before --figures--> worst values
                     failures --windows--> first and last phase, each with a neighbour that holds

Nothing here proves that a budget holds for ever: the runs begin in the states that they happen to reach, and the other
free inputs of the case take the values that it draws for them.
"""

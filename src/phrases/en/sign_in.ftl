# The page where one signs in.

sign-in = Sign in
sign-in-title = Sign in to hallsweep
sign-in-token = Token
sign-in-name = Your name (optional): the records then show which person used the key
sign-in-name-unusable = This name cannot be used: it may have up to { $most } letters, digits, blanks, dots, hyphens and apostrophes.
sign-in-overheard = This connection is not encrypted: anybody who can read the network traffic can read the token, and then command the robot.
sign-in-where = <code>hallsweep token</code> prints the tokens and links for signing in, on the machine of hallsweep. A session lasts twelve hours.
sign-in-unknown = This token is not known here: check that the token is complete and was not replaced.
sign-in-unusable = The key file access.toml cannot be used: nobody can sign in, and the robot is held. The log of hallsweep says what is wrong and what to do.

## What was not done.

sign-in-undone-stop = STOP was not carried out: you are not signed in any more. Use the robot's own switch, or sign in: STOP is then sent again. Press STOP yourself if the page does not say that STOP is confirmed.
sign-in-undone-command = Your command was not carried out: you are not signed in any more. Sign in, look at the robot, and press the button again.
sign-in-undone-watching = You are not signed in any more: you signed out, the session expired, or the key was replaced.

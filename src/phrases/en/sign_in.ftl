# The page where one signs in.

sign-in = Sign in
sign-in-title = Sign in to hallsweep
sign-in-token = Token
sign-in-name = Your name (optional), for the records: it tells people with the same key apart
sign-in-name-unusable = This name cannot be used: it may have up to { $most } letters, digits, blanks, dots, hyphens and apostrophes.
sign-in-overheard = This connection is not encrypted: whoever listens on the network between can read the token, and then command the robot.
sign-in-where = Whoever runs hallsweep finds tokens and ready links with <code>hallsweep token</code> on its machine. A session lasts twelve hours.
sign-in-unknown = This token is not known here: look whether it is whole, and whether it was replaced.
sign-in-unusable = The file of keys, access.toml, cannot be used, so nobody can sign in, and the robot is held: whoever runs hallsweep finds in its log what is wrong and what to do.

## What was not done.

sign-in-undone-stop = STOP was not given: you are not signed in any more. Use the robot's own switch, or sign in: this page then sends STOP again. Press STOP yourself if you do not read that it is confirmed.
sign-in-undone-command = What you pressed was not carried out: you are not signed in any more. Sign in, look at the robot, and press it again.
sign-in-undone-watching = You are not signed in any more: you signed out, the session is over, or the key was replaced.

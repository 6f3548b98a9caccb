# La pagina per accedere.

sign-in = Accedere
sign-in-title = Accedere a hallsweep
sign-in-token = Token
sign-in-name = Il proprio nome (facoltativo), per il registro: distingue chi usa la stessa chiave
sign-in-name-unusable = Questo nome non si può usare: può avere fino a { $most } lettere, cifre, spazi, punti, trattini e apostrofi.
sign-in-overheard = Questo collegamento non è cifrato: chi ascolta sulla rete può leggere il token, e poi comandare il robot.
sign-in-where = Chi gestisce hallsweep trova i token e i collegamenti già pronti con <code>hallsweep token</code> sulla sua macchina. Un accesso vale dodici ore.
sign-in-unknown = Questo token qui non è conosciuto: guardare se è intero, e se è stato sostituito.
sign-in-unusable = Il file delle chiavi, access.toml, non si può usare: nessuno può accedere, e il robot è bloccato. Chi gestisce hallsweep trova nel suo log che cosa non va e che cosa fare.

## Che cosa non è stato fatto.

sign-in-undone-stop = STOP non è stato dato: l'accesso non vale più. Usare l'interruttore del robot, oppure accedere: questa pagina invia allora di nuovo STOP. Premerlo di persona se non si legge che è confermato.
sign-in-undone-command = Il comando premuto non è stato eseguito: l'accesso non vale più. Accedere, guardare il robot, e premere di nuovo.
sign-in-undone-watching = L'accesso non vale più: si è usciti, è scaduto, oppure la chiave è stata sostituita.

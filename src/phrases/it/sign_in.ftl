# La pagina per accedere.

sign-in = Accedere
sign-in-title = Accedere a hallsweep
sign-in-token = Token
sign-in-name = Il proprio nome (facoltativo): il registro mostra così quale persona ha usato la chiave
sign-in-name-unusable = Questo nome non si può usare: può avere fino a { $most } lettere, cifre, spazi, punti, trattini e apostrofi.
sign-in-overheard = Questo collegamento non è cifrato: chi può leggere il traffico di rete può leggere il token, e poi comandare il robot.
sign-in-where = <code>hallsweep token</code> mostra i token e i collegamenti per accedere, sulla macchina di hallsweep. Una sessione dura dodici ore.
sign-in-unknown = Questo token qui non è conosciuto: controllare che il token sia completo e non sia stato sostituito.
sign-in-unusable = Il file delle chiavi access.toml non si può usare: nessuno può accedere, e il robot è bloccato. Il log di hallsweep dice che cosa non va e che cosa fare.

## Che cosa non è stato fatto.

sign-in-undone-stop = STOP non è stato eseguito: l'accesso non vale più. Usare l'interruttore del robot, oppure accedere: STOP viene allora inviato di nuovo. Se la pagina non dice che STOP è confermato, premere STOP di persona.
sign-in-undone-command = Il comando premuto non è stato eseguito: l'accesso non vale più. Accedere, guardare il robot, e premere di nuovo il pulsante.
sign-in-undone-watching = L'accesso non vale più: si è usciti, la sessione è scaduta, oppure la chiave è stata sostituita.
